#pragma once
/// The file service of the High Speed Ethernet Server (docs/yaskawa-protocols 2.6): jobs of a controller state as files
/// with CR LF. No sockets.

#include <cstdint>
#include <optional>
#include <string>

#include "pickcell/robot/hses_frame_codec.hpp"
#include "pickcell/sim/controller_state.hpp"

namespace pickcell::sim {

/// One transfer at a time; a new request ends the one under way. Not thread-safe.
class HsesFiles {
 public:
  static constexpr std::size_t kBlockBytes = 400;
  static constexpr std::size_t kLargestFile = 1u << 20;

  /// The answer, or nothing: the last acknowledgement of a download gets none. A block or acknowledgement that comes
  /// again is answered again and changes nothing. Jobs are checked as INFORM before they are taken.
  [[nodiscard]] std::optional<robot::HsesAnswer> handle(ControllerState& state, const robot::HsesRequest& request);

  /// The job runs: a short one may be over soon, the request can be tried again.
  [[nodiscard]] static bool in_use(const robot::HsesAnswer& answer);

 private:
  enum class Kind { none, sending, receiving };
  [[nodiscard]] robot::HsesAnswer begin(ControllerState& state, const robot::HsesRequest& request);
  [[nodiscard]] robot::HsesAnswer send_file(const robot::HsesRequest& request, std::string content);
  [[nodiscard]] robot::HsesAnswer begin_load(const ControllerState& state, const robot::HsesRequest& request);
  [[nodiscard]] robot::HsesAnswer block(const robot::HsesRequest& request) const;
  [[nodiscard]] std::optional<robot::HsesAnswer> acknowledged(const robot::HsesRequest& request);
  [[nodiscard]] robot::HsesAnswer received(ControllerState& state, const robot::HsesRequest& request);

  Kind kind_ = Kind::none;
  robot::HsesService service_{};
  std::string job_;                        ///< that is received
  std::string content_;                    ///< to send, or received so far
  std::uint32_t block_ = 0;                ///< last sent or received
  std::optional<robot::HsesAnswer> last_;  ///< to the last block received
};

}  // namespace pickcell::sim
