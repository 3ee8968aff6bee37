#pragma once
/// High Speed Ethernet Server (UDP 10040 / 10041): the 32-byte header, both directions, bytes to structs and back.
/// Source: docs/yaskawa-protocols.md 2.1. All numbers are little-endian on every controller.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <tl/expected.hpp>
#include <vector>

#include "pickcell/core/result.hpp"

namespace pickcell::robot {

using HsesBytes = std::vector<std::uint8_t>;
using HsesView = std::span<const std::uint8_t>;

constexpr std::size_t kHsesHeaderBytes = 32;
constexpr std::size_t kHsesMostPayload = 479;
/// Of a block number: the only or last block.
constexpr std::uint32_t kHsesLastBlock = 0x80000000;
/// Added status of identifier, header size and sizes that do not fit (section 2.7).
constexpr std::uint16_t kHsesBadHeaderSize = 0xE4A5, kHsesBadIdentifier = 0xE4A6, kHsesSizesDiffer = 0xE4A7,
                        kHsesTooLong = 0xE49E, kHsesBadDivision = 0xE4A3, kHsesBadAck = 0xE4A2;

enum class HsesDivision : std::uint8_t { robot = 1, file = 2 };

enum class HsesService : std::uint8_t {
  get_all = 0x01,
  set_all = 0x02,
  file_delete = 0x09,
  get_one = 0x0E,
  set_one = 0x10,
  file_load = 0x15,  ///< PC to robot
  file_save = 0x16,  ///< robot to PC
  file_list = 0x32,
  read_plural = 0x33,
  write_plural = 0x34,
};

/// What a PC sends. `ack`: a block or an acknowledgement of a file transfer instead of a request.
struct HsesRequest {
  HsesDivision division = HsesDivision::robot;
  bool ack = false;
  std::uint8_t id = 0;
  std::uint32_t block = 0;
  std::uint16_t command = 0;
  std::uint16_t instance = 0;
  std::uint8_t attribute = 0;
  HsesService service = HsesService::get_all;
  HsesBytes payload;
  bool operator==(const HsesRequest&) const = default;
};

/// What a controller answers. status 0: done.
struct HsesAnswer {
  HsesDivision division = HsesDivision::robot;
  std::uint8_t id = 0;
  std::uint32_t block = kHsesLastBlock;
  HsesService service = HsesService::get_all;  ///< of the request; goes as service + 0x80
  std::uint8_t status = 0;
  std::uint16_t added_status = 0;  ///< 0: none was sent
  HsesBytes payload;
  bool operator==(const HsesAnswer&) const = default;
};

/// Throws std::invalid_argument for more than kHsesMostPayload bytes of payload.
[[nodiscard]] HsesBytes hses_bytes(const HsesRequest& request);
[[nodiscard]] HsesBytes hses_bytes(const HsesAnswer& answer);

/// An answer, or a failure of code `link` that says what is wrong with the datagram. Reserved bytes are not looked at.
[[nodiscard]] core::Result<HsesAnswer> parse_hses_answer(HsesView datagram);

/// Why a datagram is no request: the added status to answer with and what could be read of it; nothing to answer when
/// it does not even begin like one.
struct HsesBadRequest {
  std::optional<std::uint16_t> added_status;
  std::uint8_t id = 0;
  std::uint8_t service = 0;
};
[[nodiscard]] tl::expected<HsesRequest, HsesBadRequest> parse_hses_request(HsesView datagram);

/// Little-endian numbers one after the other.
class HsesWriter {
 public:
  HsesWriter& u8(std::uint8_t v);
  HsesWriter& u16(std::uint16_t v);
  HsesWriter& u32(std::uint32_t v);
  HsesWriter& i32(std::int32_t v) { return u32(static_cast<std::uint32_t>(v)); }
  HsesWriter& f32(float v);
  /// Exactly `size` bytes: cut, or filled up with NULs.
  HsesWriter& text(std::string_view text, std::size_t size);
  HsesWriter& bytes(HsesView more);
  [[nodiscard]] HsesBytes take() { return std::move(bytes_); }

 private:
  HsesBytes bytes_;
};

/// Reads them back; past the end everything is 0 and good() is false.
class HsesReader {
 public:
  explicit HsesReader(HsesView bytes) : left_(bytes) {}
  [[nodiscard]] std::uint8_t u8();
  [[nodiscard]] std::uint16_t u16();
  [[nodiscard]] std::uint32_t u32();
  [[nodiscard]] std::int32_t i32() { return static_cast<std::int32_t>(u32()); }
  [[nodiscard]] float f32();
  /// `size` bytes up to the first NUL, blanks at the end cut off.
  [[nodiscard]] std::string text(std::size_t size);
  [[nodiscard]] HsesView rest() const { return left_; }
  [[nodiscard]] bool good() const { return good_; }

 private:
  [[nodiscard]] HsesView take(std::size_t size);
  HsesView left_;
  bool good_ = true;
};

}  // namespace pickcell::robot
