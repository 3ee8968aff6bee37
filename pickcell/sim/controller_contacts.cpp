#include "pickcell/sim/controller_contacts.hpp"

namespace pickcell::sim {

namespace {

/// First group of each kind; "last" where all controllers agree (docs/yaskawa-protocols 2.5).
constexpr int kInput = 1, kOutput = 1001, kExternalInput = 2001, kNetworkOutputOffset = 1000, kExternalOutput = 3001,
              kSystemInput = 4001, kSystemOutput = 5001, kPanel = 6001, kPanelLast = 6064, kRelay = 7001,
              kRelayLast = 7999, kControl = 8001;

std::uint8_t general(const GeneralContacts& contacts, int nth_group) {
  const int first = nth_group * 8 + 1;
  std::uint8_t value = 0;
  for (int bit = 0; bit < 8; ++bit)
    if (contacts[static_cast<std::size_t>(first + bit)]) value = static_cast<std::uint8_t>(value | 1 << bit);
  return value;
}

std::uint8_t bits(std::initializer_list<std::pair<int, bool>> set) {
  int value = 0;
  for (const auto& [bit, on] : set) value |= on ? 1 << bit : 0;
  return static_cast<std::uint8_t>(value);
}

/// The contacts that other programs are known to read: 50010 alarm, 50014 error, 50053 teach, 50054 play, 50070
/// running, 50071 hold, 50073 servo, 80011 remote, 80025-80027 emergency stop.
std::uint8_t system_group(const ControllerState& s, int group) {
  switch (group) {
    case 5001:
      return bits({{0, !s.alarms.empty()}, {4, s.error}});
    case 5005:
      return bits({{3, !s.play}, {4, s.play}});
    case 5007:
      return bits({{0, s.running()}, {1, s.held()}, {3, s.servo}});
    case 8001:
      return bits({{1, s.remote}});
    case 8002:
      return bits({{6, s.emergency_stop}});
    default:
      return 0;
  }
}

bool within(int group, int first, int last) { return group >= first && group <= last; }

}  // namespace

std::optional<std::uint8_t> read_group(const ControllerState& s, int group) {
  const int general_groups = s.type.general_groups;
  const int network_first = s.type.network_input_first / 10, network_last = s.type.network_input_last / 10;
  if (within(group, kInput, general_groups)) return general(s.inputs, group - kInput);
  if (within(group, kOutput, kOutput + general_groups - 1)) return general(s.outputs, group - kOutput);
  if (within(group, network_first, network_last)) {
    const auto found = s.network_inputs.find(group);
    return found == s.network_inputs.end() ? std::uint8_t{0} : found->second;
  }
  const bool known = within(group, kExternalInput, kExternalInput + general_groups - 1) ||
                     within(group, kExternalOutput, kExternalOutput + general_groups - 1) ||
                     within(group, network_first + kNetworkOutputOffset, network_last + kNetworkOutputOffset) ||
                     within(group, kSystemInput, s.type.system_input_last) || within(group, kPanel, kPanelLast) ||
                     within(group, kRelay, kRelayLast) || within(group, kSystemOutput, s.type.system_output_last) ||
                     within(group, kControl, s.type.control_last) ||
                     within(group, s.type.pseudo_first, s.type.pseudo_last);
  if (!known) return std::nullopt;
  return system_group(s, group);
}

bool write_group(ControllerState& s, int group, std::uint8_t value) {
  if (!within(group, s.type.network_input_first / 10, s.type.network_input_last / 10)) return false;
  std::uint8_t& held = s.network_inputs[group];
  for (int bit = 0; bit < 8; ++bit) {
    const bool on = (value >> bit & 1) != 0;
    if (on != ((held >> bit & 1) != 0)) s.contact_events.push_back({group * 10 + bit, on});
  }
  held = value;
  return true;
}

void set_output(ControllerState& s, int n, bool on) {
  auto contact = s.outputs[static_cast<std::size_t>(n)];
  if (contact == on) return;
  contact = on;
  s.output_events.push_back({n, on});
}

}  // namespace pickcell::sim
