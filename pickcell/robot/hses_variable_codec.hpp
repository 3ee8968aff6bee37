#pragma once
/// Variables over the High Speed Ethernet Server: what single and plural commands carry beyond plain numbers.
/// Source: docs/yaskawa-protocols.md 2.2. Parsers as in hses_codec.hpp.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

#include "pickcell/core/result.hpp"
#include "pickcell/robot/hses_frame_codec.hpp"

namespace pickcell::robot {

/// Plural commands.
constexpr std::uint16_t kHsesPluralIo = 0x300, kHsesPluralRegister = 0x301, kHsesPluralB = 0x302, kHsesPluralI = 0x303,
                        kHsesPluralD = 0x304, kHsesPluralR = 0x305, kHsesPluralS = 0x306, kHsesPluralP = 0x307,
                        kHsesPluralBp = 0x308, kHsesPluralEx = 0x309;

/// `count` elements from `first` (B and I/O: an even count). Counts that do not fit a datagram throw
/// std::invalid_argument.
[[nodiscard]] HsesRequest hses_read_plural(std::uint16_t command, std::uint16_t first, std::uint32_t count);
[[nodiscard]] HsesRequest hses_write_plural(std::uint16_t command, std::uint16_t first, std::uint32_t count,
                                            HsesBytes elements);
/// Bytes of one element of a plural command; 0 when it is none.
[[nodiscard]] std::size_t hses_element_bytes(std::uint16_t plural_command);
/// The most elements in one datagram (section 2.2); 0 when it is no plural command.
[[nodiscard]] std::uint32_t hses_most_elements(std::uint16_t plural_command);
/// The elements of a plural answer: the count asked for, then exactly that many elements.
[[nodiscard]] core::Result<HsesBytes> parse_hses_plural(HsesView payload, std::uint16_t plural_command,
                                                        std::uint32_t count);

/// BP (0x80) and EX (0x81): u32 type, then eight axes.
struct HsesAxesPosition {
  std::uint32_t type = 0;
  std::array<std::int32_t, 8> axes{};
  bool operator==(const HsesAxesPosition&) const = default;
};
constexpr std::size_t kHsesAxesPositionBytes = 36;
[[nodiscard]] core::Result<HsesAxesPosition> parse_hses_axes_position(HsesView payload);
[[nodiscard]] HsesBytes hses_payload(const HsesAxesPosition& position);

/// S: 16 bytes (0x7E) or 32 (0x8C), filled up with NULs.
constexpr std::size_t kHsesShortString = 16, kHsesLongString = 32;
[[nodiscard]] core::Result<std::string> parse_hses_string(HsesView payload);
/// More than `size` bytes throw std::invalid_argument.
[[nodiscard]] HsesBytes hses_string(std::string_view text, std::size_t size);

}  // namespace pickcell::robot
