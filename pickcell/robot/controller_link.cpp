#include "pickcell/robot/controller_link.hpp"

namespace pickcell::robot {

core::Error ControllerLink::lacks(const std::string& what) const {
  return {core::ErrorCode::usage, peer(), protocol() + " has no " + what, instead(), {}};
}

core::Result<std::vector<Alarm>> ControllerLink::read_past_alarms(AlarmHistory, int) {
  return tl::unexpected(lacks("history of alarms"));
}
core::Result<std::vector<std::int32_t>> ControllerLink::read_pulses() { return tl::unexpected(lacks("pulses")); }
core::Result<CurrentJob> ControllerLink::read_job() { return tl::unexpected(lacks("jobs")); }

core::Result<std::int32_t> ControllerLink::read_integer(VariableType, int) {
  return tl::unexpected(lacks("variables"));
}
core::Result<double> ControllerLink::read_real(int) { return tl::unexpected(lacks("variables")); }
core::Result<std::string> ControllerLink::read_string(int) { return tl::unexpected(lacks("variables")); }
core::Result<VariablePosition> ControllerLink::read_position_variable(int) {
  return tl::unexpected(lacks("variables"));
}
core::Status ControllerLink::write_integer(VariableType, int, std::int32_t) {
  return tl::unexpected(lacks("variables"));
}
core::Status ControllerLink::write_real(int, double) { return tl::unexpected(lacks("variables")); }
core::Status ControllerLink::write_string(int, const std::string&) { return tl::unexpected(lacks("variables")); }
core::Status ControllerLink::write_position_variable(int, const VariablePosition&) {
  return tl::unexpected(lacks("variables"));
}
core::Result<std::uint16_t> ControllerLink::read_register(int) { return tl::unexpected(lacks("registers")); }
core::Status ControllerLink::write_register(int, std::uint16_t) { return tl::unexpected(lacks("registers")); }

core::Status ControllerLink::set_cycle(Cycle) { return tl::unexpected(lacks("choice of the cycle")); }
core::Status ControllerLink::show_message(const std::string&) { return tl::unexpected(lacks("messages")); }
core::Status ControllerLink::select_job(const std::string&, int) { return tl::unexpected(lacks("jobs")); }
core::Status ControllerLink::set_master_job(const std::string&) { return tl::unexpected(lacks("jobs")); }
core::Status ControllerLink::start_job(const std::string&) { return tl::unexpected(lacks("jobs")); }
core::Status ControllerLink::move_pulses(const PulseMove&) { return tl::unexpected(lacks("moves in pulses")); }

core::Result<std::vector<std::string>> ControllerLink::list_jobs() { return tl::unexpected(lacks("jobs")); }
core::Result<std::string> ControllerLink::read_job_text(const std::string&) { return tl::unexpected(lacks("files")); }
core::Status ControllerLink::write_job_text(const std::string&, const std::string&) {
  return tl::unexpected(lacks("files"));
}
core::Status ControllerLink::delete_job(const std::string&) { return tl::unexpected(lacks("jobs")); }

}  // namespace pickcell::robot
