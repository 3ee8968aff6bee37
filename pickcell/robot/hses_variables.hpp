#pragma once
/// Variables, registers and contacts over a High Speed Ethernet Server, one by one and many at once.
/// Source: docs/yaskawa-protocols.md 2.2 (0x78-0x81, 0x8C, 0x300-0x309).

#include <cstdint>
#include <string>
#include <vector>

#include "pickcell/core/result.hpp"
#include "pickcell/robot/controller_link.hpp"
#include "pickcell/robot/hses_codec.hpp"
#include "pickcell/robot/hses_session.hpp"

namespace pickcell::robot {

/// Over a session that must outlive it. Reads and writes may be repeated (HsesSession). `first` and `count` of the
/// plural forms: what does not fit a datagram (hses_most_elements), an odd count of B or groups, or a variable number
/// beyond 16 bits throws std::invalid_argument.
class HsesVariables {
 public:
  explicit HsesVariables(HsesSession& session) : session_(session) {}

  /// B, I, D.
  [[nodiscard]] core::Result<std::int32_t> read_integer(VariableType type, int number);
  [[nodiscard]] core::Status write_integer(VariableType type, int number, std::int32_t value);
  [[nodiscard]] core::Result<std::vector<std::int32_t>> read_integers(VariableType type, int first, int count);
  [[nodiscard]] core::Status write_integers(VariableType type, int first, const std::vector<std::int32_t>& values);

  [[nodiscard]] core::Result<double> read_real(int number);
  [[nodiscard]] core::Status write_real(int number, double value);
  [[nodiscard]] core::Result<std::vector<double>> read_reals(int first, int count);
  [[nodiscard]] core::Status write_reals(int first, const std::vector<double>& values);

  /// 32 bytes where the controller has them (YRC1000), else 16.
  [[nodiscard]] core::Result<std::string> read_string(int number);
  /// Up to 16 bytes on every controller, up to 32 where it has them.
  [[nodiscard]] core::Status write_string(int number, const std::string& value);
  /// The first 16 bytes of each.
  [[nodiscard]] core::Result<std::vector<std::string>> read_strings(int first, int count);
  [[nodiscard]] core::Status write_strings(int first, const std::vector<std::string>& values);

  /// P.
  [[nodiscard]] core::Result<VariablePosition> read_position(int number);
  [[nodiscard]] core::Status write_position(int number, const VariablePosition& position);
  [[nodiscard]] core::Result<std::vector<HsesPosition>> read_positions(int first, int count);
  [[nodiscard]] core::Status write_positions(int first, const std::vector<HsesPosition>& positions);

  /// BP (base axes) or EX (stations).
  enum class Axes { base, station };
  [[nodiscard]] core::Result<HsesAxesPosition> read_axes(Axes which, int number);
  [[nodiscard]] core::Status write_axes(Axes which, int number, const HsesAxesPosition& position);
  [[nodiscard]] core::Result<std::vector<HsesAxesPosition>> read_many_axes(Axes which, int first, int count);
  [[nodiscard]] core::Status write_many_axes(Axes which, int first, const std::vector<HsesAxesPosition>& positions);

  /// M registers.
  [[nodiscard]] core::Result<std::uint16_t> read_register(int number);
  [[nodiscard]] core::Status write_register(int number, std::uint16_t value);
  [[nodiscard]] core::Result<std::vector<std::uint16_t>> read_registers(int first, int count);
  [[nodiscard]] core::Status write_registers(int first, const std::vector<std::uint16_t>& values);

  /// Groups of eight contacts by their number / 10.
  [[nodiscard]] core::Result<std::uint8_t> read_group(int group);
  [[nodiscard]] core::Status write_group(int group, std::uint8_t value);
  [[nodiscard]] core::Result<std::vector<std::uint8_t>> read_groups(int first, int count);
  [[nodiscard]] core::Status write_groups(int first, const std::vector<std::uint8_t>& values);

 private:
  /// `decode` turns the next element of a reader into a value.
  template <class Value, class Decode>
  [[nodiscard]] core::Result<std::vector<Value>> read_many(std::uint16_t command, int first, int count,
                                                           const std::string& what, Decode decode);
  [[nodiscard]] core::Status write_many(std::uint16_t command, int first, std::size_t count, HsesBytes elements,
                                        const std::string& what);

  HsesSession& session_;
};

}  // namespace pickcell::robot
