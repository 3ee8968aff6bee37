#pragma once
/// A PC's side of a Yaskawa High Speed Ethernet Server: one datagram out, one back, each within one deadline.
/// Source: docs/yaskawa-protocols.md section 2.

#include <chrono>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/robot/controller_link.hpp"
#include "pickcell/robot/datagram_link.hpp"
#include "pickcell/robot/hses_codec.hpp"

namespace pickcell::robot {

struct HsesSettings {
  std::string host;
  int port = 10040;                              ///< of robot control; files are on the next one
  std::chrono::milliseconds timeout{300};        ///< for the answer to one datagram
  int tries = 3;                                 ///< of what may be repeated
  std::chrono::milliseconds busy_pause{20};      ///< between tries when the controller says that it is busy
  std::chrono::milliseconds file_timeout{2000};  ///< for an answer of the file service
};

/// One thread at a time. Errors as in ControllerLink; every error carries the last requests and answers.
///
/// Answers are matched by request id, service and division; anything else (duplicates, late answers, strangers) is
/// dropped. Reads, writes of variables and contacts and "hold on" are repeated when no answer comes or the controller
/// is busy: doing them twice is the same as once. Everything else is sent exactly once. After an unanswered request the
/// link counts as lost until connect().
class HsesClient final : public ControllerLink {
 public:
  explicit HsesClient(HsesSettings settings);

  /// Asks for the status, so that somebody is known to be there.
  [[nodiscard]] core::Status connect() override;
  [[nodiscard]] bool connected() const override { return open_; }
  void disconnect() override;
  [[nodiscard]] std::string peer() const override;
  [[nodiscard]] core::Result<std::string> identity() override;

  [[nodiscard]] core::Result<RobotState> read_status() override;
  [[nodiscard]] core::Result<std::vector<Alarm>> read_alarms() override;
  [[nodiscard]] core::Result<CartesianPosition> read_position(int frame) override;
  [[nodiscard]] core::Result<std::vector<std::int32_t>> read_pulses() override;
  [[nodiscard]] core::Result<CurrentJob> read_job() override;
  [[nodiscard]] core::Result<std::int32_t> read_integer(VariableType type, int number) override;
  [[nodiscard]] core::Result<double> read_real(int number) override;
  [[nodiscard]] core::Result<VariablePosition> read_position_variable(int number) override;
  [[nodiscard]] core::Status write_integer(VariableType type, int number, std::int32_t value) override;
  [[nodiscard]] core::Status write_real(int number, double value) override;
  [[nodiscard]] core::Status write_position_variable(int number, const VariablePosition& position) override;
  [[nodiscard]] core::Result<std::vector<std::uint8_t>> read_contacts(int first, int groups) override;
  [[nodiscard]] core::Status write_contacts(int first, const std::vector<std::uint8_t>& groups) override;
  [[nodiscard]] core::Status hold(bool on) override;
  [[nodiscard]] core::Status reset_alarm() override;
  [[nodiscard]] core::Status cancel_error() override;
  [[nodiscard]] core::Status servo(bool on) override;
  [[nodiscard]] core::Status start_job(const std::string& job) override;
  [[nodiscard]] core::Status move(const DirectMove& move) override;
  [[nodiscard]] core::Result<std::vector<std::string>> list_jobs() override;
  [[nodiscard]] core::Result<std::string> read_job_text(const std::string& job) override;
  [[nodiscard]] core::Status write_job_text(const std::string& job, const std::string& text) override;
  [[nodiscard]] core::Status delete_job(const std::string& job) override;

  // what other protocols do not have
  [[nodiscard]] core::Result<HsesSystemInfo> read_system(std::uint16_t instance = 11);
  [[nodiscard]] core::Result<std::array<std::int32_t, 8>> read_torque();
  /// Up to 118 D variables, 237 I or 474 B (an even number) in one request.
  [[nodiscard]] core::Result<std::vector<std::int32_t>> read_integers(VariableType type, int first, int count);
  [[nodiscard]] core::Status set_cycle(std::uint32_t mode);
  [[nodiscard]] core::Status show_message(const std::string& text);

 private:
  enum class Repeat { no, yes };
  /// The answer's payload; refusals as errors.
  [[nodiscard]] core::Result<HsesBytes> ask(HsesRequest request, Repeat repeat, const std::string& what);
  [[nodiscard]] core::Result<HsesAnswer> exchange(DatagramLink& link, HsesRequest& request,
                                                  std::chrono::milliseconds time);
  [[nodiscard]] core::Result<HsesAnswer> await(DatagramLink& link, const HsesRequest& request, WallDeadline deadline);
  [[nodiscard]] core::Status tell(HsesRequest request, Repeat repeat, const std::string& what);
  [[nodiscard]] core::Result<HsesBytes> download(HsesService service, const std::string& name);
  [[nodiscard]] core::Status upload(const std::string& name, const std::string& text);
  [[nodiscard]] core::Result<HsesAnswer> file_exchange(DatagramLink& link, HsesRequest request, Repeat repeat,
                                                       const std::string& what);
  [[nodiscard]] core::Result<DatagramLink> open_files() const;
  [[nodiscard]] core::Error refusal(const std::string& what, const HsesAnswer& answer) const;
  template <class Parse>
  auto read(HsesRequest request, const std::string& what, Parse parse) -> decltype(parse(HsesView{}));
  void remember(const std::string& text);
  core::Error with_trail(core::Error error) const;

  HsesSettings settings_;
  std::optional<DatagramLink> link_;
  bool open_ = false;
  std::uint8_t next_id_ = 0;
  std::deque<std::string> trail_;
};

}  // namespace pickcell::robot
