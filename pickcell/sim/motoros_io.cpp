#include "pickcell/sim/motoros_io.hpp"

#include <optional>

#include "pickcell/sim/controller_contacts.hpp"

namespace pickcell::sim {

namespace moto = robot::moto;
using robot::MotoFrame;
using robot::MotoValue;
using robot::MotoWritten;

namespace {

constexpr std::uint32_t kReadableRegisters = 1000, kWritableRegisters = 560;
constexpr std::uint32_t kFirstOutputGroup = 1001;
constexpr std::uint32_t kHighestGroup = 100'000;  // far above any; so that numbers stay small

std::optional<std::uint8_t> group_at(const ControllerState& s, std::uint32_t group) {
  return group < kHighestGroup ? read_group(s, static_cast<int>(group)) : std::nullopt;
}

bool write_whole_group(ControllerState& s, std::uint32_t group, std::uint32_t value) {
  if (group >= kHighestGroup) return false;
  if (group >= kFirstOutputGroup && group < kFirstOutputGroup + static_cast<std::uint32_t>(s.type.general_groups)) {
    for (std::uint32_t bit = 0; bit < 8; ++bit)
      set_output(s, static_cast<int>((group - kFirstOutputGroup) * 8 + bit + 1), (value >> bit & 1) != 0);
    return true;
  }
  return write_group(s, static_cast<int>(group), static_cast<std::uint8_t>(value));
}

MotoValue read_bit(const ControllerState& s, std::uint32_t contact) {
  const auto group = contact % 10 < 8 ? group_at(s, contact / 10) : std::nullopt;
  if (!group) return {0, moto::bad_read_address};
  return {static_cast<std::uint32_t>(*group >> contact % 10 & 1), moto::io_ok};
}

MotoWritten write_bit(ControllerState& s, std::uint32_t contact, std::uint32_t value) {
  const auto held = contact % 10 < 8 ? group_at(s, contact / 10) : std::nullopt;
  if (!held) return {moto::bad_write_address};
  const std::uint32_t mask = 1u << contact % 10;
  // Tried with the value that is there first: an address that cannot be written comes before a wrong value.
  if (!write_whole_group(s, contact / 10, *held)) return {moto::bad_write_address};
  if (value > 1) return {moto::bad_value};
  (void)write_whole_group(s, contact / 10, value ? *held | mask : *held & ~mask);
  return {moto::io_ok};
}

MotoWritten write_group_of(ControllerState& s, std::uint32_t group, std::uint32_t value) {
  const auto held = group_at(s, group);
  if (!held || !write_whole_group(s, group, *held)) return {moto::bad_write_address};
  if (value > 0xFF) return {moto::bad_value};
  (void)write_whole_group(s, group, value);
  return {moto::io_ok};
}

MotoValue read_register(const ControllerState& s, std::uint32_t n) {
  if (n >= kReadableRegisters) return {0, moto::bad_read_address};
  return {s.M[n], moto::io_ok};
}

MotoWritten write_register(ControllerState& s, std::uint32_t n, std::uint32_t value) {
  if (n >= kWritableRegisters) return {moto::bad_write_address};
  if (value > 0xFFFF) return {moto::bad_value};
  s.M[n] = static_cast<std::uint16_t>(value);
  return {moto::io_ok};
}

MotoFrame refused(std::int32_t subcode) { return moto_frame(robot::MotoIoRefusal{moto::invalid, subcode}); }

template <class Act>
MotoFrame reading(const MotoFrame& message, Act act) {
  const auto request = robot::parse_moto_address(message, message.type);
  return request ? moto_frame(moto::io_reply(message.type), act(request->address)) : refused(moto::size);
}

template <class Act>
MotoFrame writing(const MotoFrame& message, Act act) {
  const auto request = robot::parse_moto_write(message, message.type);
  return request ? moto_frame(moto::io_reply(message.type), act(request->address, request->value))
                 : refused(moto::size);
}

}  // namespace

bool is_motoros_io(const MotoFrame& message) {
  return message.type >= moto::kReadBit && message.type <= moto::kWriteRegister && message.type != moto::kIoReply;
}

MotoFrame execute_motoros_io(ControllerState& s, const MotoFrame& message) {
  switch (message.type) {
    case moto::kReadBit:
      return reading(message, [&](std::uint32_t contact) { return read_bit(s, contact); });
    case moto::kReadGroup:
      return reading(message, [&](std::uint32_t group) {
        const auto value = group_at(s, group);
        return value ? MotoValue{*value, moto::io_ok} : MotoValue{0, moto::bad_read_address};
      });
    case moto::kReadRegister:
      return reading(message, [&](std::uint32_t n) { return read_register(s, n); });
    case moto::kWriteBit:
      return writing(message, [&](std::uint32_t contact, std::uint32_t v) { return write_bit(s, contact, v); });
    case moto::kWriteGroup:
      return writing(message, [&](std::uint32_t group, std::uint32_t v) { return write_group_of(s, group, v); });
    case moto::kWriteRegister:
      return writing(message, [&](std::uint32_t n, std::uint32_t v) { return write_register(s, n, v); });
    default:
      return refused(moto::type);
  }
}

}  // namespace pickcell::sim
