#pragma once
/// The simulated camera served over GigE Vision: what a program on the network sees is a camera like any other. Aravis'
/// fake camera speaks the protocol, the simulated camera takes the pictures.

#include <memory>
#include <string>

#include "pickcell/core/clock.hpp"
#include "pickcell/core/result.hpp"
#include "pickcell/sim/camera.hpp"

namespace pickcell::sim {

class GigeCamera {
 public:
  struct Settings {
    std::string bind = "127.0.0.1";  ///< address of one of this machine's network interfaces
    std::string serial = "SIM01";    ///< at most 15 characters
    double fps = 5;                  ///< of free running
    bool still = false;              ///< takes one picture only and sends it each time: rendering then costs no time
  };

  /// Answers at the address on the protocol's port (UDP 3956). camera and clock must outlive it; nobody else may expose
  /// with the camera. Pictures: exposure from now minus exposure time until now, on the given clock, which is also the
  /// camera's own clock. Formats Mono8, Mono16, RGB8, Bayer..8; region, exposure time, gain (dB), frame rate, software
  /// trigger. Errors: device: no such address, or another camera answers there already.
  [[nodiscard]] static core::Result<std::unique_ptr<GigeCamera>> switch_on(Settings settings, SimulatedCamera& camera,
                                                                           const core::Clock& clock);
  ~GigeCamera();
  GigeCamera(const GigeCamera&) = delete;
  GigeCamera& operator=(const GigeCamera&) = delete;

  /// As clients write it: "aravis:127.0.0.1".
  [[nodiscard]] std::string source() const;

 private:
  struct Served;
  explicit GigeCamera(std::unique_ptr<Served> served);
  std::unique_ptr<Served> served_;
};

}  // namespace pickcell::sim
