#pragma once
/// MotoROS as `pickcell robot` sees a controller: state, contacts, joints, slow moves. Variables, jobs and pulses it
/// does not have; asking for them is usage.

#include <array>
#include <atomic>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "pickcell/robot/controller_link.hpp"
#include "pickcell/robot/motoros_client.hpp"
#include "pickcell/robot/motoros_move.hpp"

namespace pickcell::robot {

struct MotoRosLinkSettings {
  MotoRosClientSettings client;
  /// gp7, gp8, motomini. Needed for poses and moves: MotoROS tells joints only. "": those are usage.
  std::string model;
  /// Whatever a move asks for, it is refused beyond this. The greatest speeds that commissioning allows at all.
  double most_fraction = 0.25, most_mm_s = 250;
  std::array<double, 3> box_min_mm{-2000, -2000, -500}, box_max_mm{2000, 2000, 2000};  ///< of the flange
};

/// As ControllerLink. Positions are those of the flange (tool 0, base frame), computed from the joints. Which of the
/// holds is on MotoROS does not say: shown as external. hold(true) ends the motion; there is nothing that hold(false)
/// could take back. move() returns when the way was found safe and a thread streams it; `running` in read_status()
/// tells when it has ended, and a move that failed is the error of the next read_status(). The destructor stops a move.
class MotoRosLink final : public ControllerLink {
 public:
  /// Throws std::invalid_argument for a model that is not known.
  explicit MotoRosLink(MotoRosLinkSettings settings);

  ~MotoRosLink() override;
  MotoRosLink(const MotoRosLink&) = delete;
  MotoRosLink& operator=(const MotoRosLink&) = delete;

  [[nodiscard]] core::Status connect() override;
  [[nodiscard]] bool connected() const override { return order_.has_value(); }
  void disconnect() override;
  [[nodiscard]] std::string peer() const override { return watch_.peer(); }
  [[nodiscard]] std::string protocol() const override { return "MotoROS"; }
  [[nodiscard]] core::Result<std::string> identity() override;

  [[nodiscard]] core::Result<RobotState> read_status() override;
  [[nodiscard]] core::Result<std::vector<Alarm>> read_alarms() override;
  [[nodiscard]] core::Result<CartesianPosition> read_position(int frame) override;
  [[nodiscard]] core::Result<std::uint16_t> read_register(int number) override;
  [[nodiscard]] core::Status write_register(int number, std::uint16_t value) override;
  [[nodiscard]] core::Result<std::vector<std::uint8_t>> read_contacts(int first, int groups) override;
  [[nodiscard]] core::Status write_contacts(int first, const std::vector<std::uint8_t>& groups) override;
  [[nodiscard]] core::Status hold(bool on) override;
  [[nodiscard]] core::Status reset_alarm() override;
  [[nodiscard]] core::Status cancel_error() override { return reset_alarm(); }
  [[nodiscard]] core::Status servo(bool on) override;
  [[nodiscard]] core::Status move(const DirectMove& move) override;

 protected:
  [[nodiscard]] std::string instead() const override { return "use tcp80:// or hses://"; }

 private:
  [[nodiscard]] core::Status needs_model(const std::string& for_what) const;
  [[nodiscard]] core::Result<std::vector<MotoTrajectoryPoint>> plan(const DirectMove& move, const ArmJoints& from,
                                                                    const MotoRosLimits& limits) const;
  /// A move runs in the thread, which alone uses motion_ then.
  [[nodiscard]] core::Status standing() const;
  void end_move();

  MotoRosLinkSettings settings_;
  const ArmGeometry* arm_ = nullptr;
  std::optional<ByteOrder> order_;
  MotoRosClient motion_, watch_;
  std::atomic<bool> moving_ = false, stop_asked_ = false;
  core::Status moved_;  ///< of the last move; to be read when moving_ is false
  std::jthread mover_;
};

}  // namespace pickcell::robot
