#pragma once
/// Operands of the Ethernet Server as fields between commas; a number is the whole field or none.

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

namespace pickcell::sim::tcp80_fields {

/// Without blanks, line ends and NULs around it.
[[nodiscard]] std::string_view trimmed(std::string_view text);
/// Trimmed fields; none when there is nothing but padding.
[[nodiscard]] std::vector<std::string_view> split(std::string_view operands);
/// Finite, no exponent.
[[nodiscard]] std::optional<double> number(std::string_view field);
/// A whole number within low..high (both inside the range of 32 bits); `1.000` counts as 1.
[[nodiscard]] std::optional<std::int32_t> whole(std::string_view field, double low, double high);

}  // namespace pickcell::sim::tcp80_fields
