#pragma once
/// The two questions that can be asked of any GigE Vision camera without holding it: who are you (discovery), and what
/// is in this register. GigE Vision 2.0, control protocol; big endian. Bytes <-> structs only.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

namespace pickcell::frames::gvcp {

constexpr std::uint16_t kPort = 3956;
constexpr std::uint32_t kHeartbeatTimeoutRegister = 0x0938;  ///< ms
constexpr std::uint32_t kControlRegister = 0x0a00;           ///< control channel privilege
constexpr std::uint32_t kControllerPortRegister = 0x0a04;    ///< of the holder; 0 where the camera does not tell
constexpr std::uint32_t kControllerAddressRegister = 0x0a14;
constexpr std::uint32_t kHeldBits = 0x3;  ///< of the control register: exclusive, control

/// READREG_CMD with acknowledge.
[[nodiscard]] std::array<std::byte, 12> read_register(std::uint32_t address, std::uint16_t request_id);
/// DISCOVERY_CMD with acknowledge.
[[nodiscard]] std::array<std::byte, 8> discovery(std::uint16_t request_id);

struct RegisterAnswer {
  std::uint16_t status = 0;  ///< 0: done
  std::uint32_t value = 0;
};
/// READREG_ACK of that request; unset for anything else.
[[nodiscard]] std::optional<RegisterAnswer> parse_register(std::span<const std::byte> datagram,
                                                           std::uint16_t request_id);

struct Identity {
  std::uint32_t address = 0;  ///< IPv4, host byte order
  std::string mac, vendor, model, version, serial, user_name;
};
/// DISCOVERY_ACK of that request; unset for anything else. Texts end at their first zero; bytes that do not print are
/// replaced.
[[nodiscard]] std::optional<Identity> parse_discovery(std::span<const std::byte> datagram, std::uint16_t request_id);

/// "192.168.1.20"
[[nodiscard]] std::string dotted(std::uint32_t address);

}  // namespace pickcell::frames::gvcp
