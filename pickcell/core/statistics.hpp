#pragma once
/// Summaries of measured values.

#include <optional>
#include <vector>

namespace pickcell::core {

/// The value below which the fraction q (0..1) of the values lies, linear between neighbours (numpy's default). Empty
/// for no values.
[[nodiscard]] std::optional<double> quantile(std::vector<double> values, double q);
[[nodiscard]] std::optional<double> median(std::vector<double> values);
[[nodiscard]] std::optional<double> mean(const std::vector<double>& values);

}  // namespace pickcell::core
