#include "pickcell/matches/learn/fourier.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <random>
#include <vector>

namespace pickcell::matches {
namespace {

TEST(Fourier, IsTheSumItStandsForAndBack) {
  constexpr int kSize = 32;
  std::mt19937 random(3);
  std::uniform_real_distribution<float> u(-1, 1);
  std::vector<std::complex<float>> values(kSize);
  for (auto& v : values) v = {u(random), u(random)};
  auto transformed = values;
  const Fourier fourier(kSize);
  fourier.forward(transformed.data());
  for (int n = 0; n < kSize; ++n) {
    std::complex<double> sum = 0;
    for (int i = 0; i < kSize; ++i)
      sum += std::complex<double>(values[static_cast<std::size_t>(i)]) *
             std::polar(1.0, -2 * std::numbers::pi * n * i / kSize);
    EXPECT_NEAR(std::abs(std::complex<double>(transformed[static_cast<std::size_t>(n)]) - sum), 0, 1e-5);
  }
  fourier.inverse(transformed.data());
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(std::abs(transformed[i] / 32.0f - values[i]), 0, 1e-5);
}

}  // namespace
}  // namespace pickcell::matches
