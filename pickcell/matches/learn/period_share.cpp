#include "pickcell/matches/learn/period_share.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "pickcell/matches/learn/fourier.hpp"

namespace pickcell::matches {

namespace {

constexpr double kClip = 0.25;        ///< of the contrast: a mark is not to outweigh many small teeth
constexpr double kTeethGrey = 0.03;   ///< amplitude, of the contrast: the pixel grid gives less
constexpr double kTeethCover = 0.12;  ///< of the smoothed mask: binary outlines grown by pixels give less
constexpr double kAboveFloor = 4;     ///< times the power of an ordinary harmonic
constexpr double kAboveBeside = 3;    ///< times that of the harmonics beside it: a mark has them all alike
constexpr int kShape = 3;             ///< harmonics of a period that make its amplitude
constexpr int kTogether = 3;          ///< rings, over which powers are averaged

/// The powers of a ring's harmonics; [0] is left out.
using Power = std::vector<double>;

/// Sums over rings.
struct Tally {
  Tally(int harmonics, int periods)
      : energy(static_cast<std::size_t>(harmonics) + 1, 0.0), seen(static_cast<std::size_t>(periods) + 1, false) {}

  void add(const Power& power, double area, double least_amplitude) {
    Power sorted(power.begin() + 1, power.end());
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    const double floor = *middle;
    const double little = std::max(kAboveFloor * floor, least_amplitude * least_amplitude / 8);  // half the amplitude
    for (std::size_t h = 1; h < power.size(); ++h) energy[h] += area * std::max(0.0, power[h] - little);
    for (std::size_t k = 2; k < seen.size(); ++k) {
      double sum = 0, beside = 0;
      int count = 0;
      for (std::size_t h = k; h + 1 < power.size() && count < kShape; h += k, ++count) {
        sum += power[h];
        beside += (power[h - 1] + power[h + 1]) / 2;
      }
      const bool strong = sum > 2 * kAboveFloor * count * floor && std::sqrt(2 * sum) > least_amplitude;
      if (strong && sum > kAboveBeside * beside) seen[k] = true;
    }
  }
  [[nodiscard]] std::vector<double> shares() const {
    std::vector<double> out(seen.size(), 0.0);
    double total = 0;
    for (const double e : energy) total += e;
    for (std::size_t k = 2; k < out.size() && total > 0; ++k)
      for (std::size_t h = k; h < energy.size() && seen[k]; h += k) out[k] += energy[h] / total;
    return out;
  }

  std::vector<double> energy;
  std::vector<bool> seen;  ///< by period: somewhere strong enough
};

/// Of grey (in parts of the contrast) or of the mask along a ring.
Power power_of(const Rings::Sample* rest, bool mask, double unit, const Fourier& fourier, int angles, int harmonics) {
  std::vector<Rings::Sample> ring(static_cast<std::size_t>(angles));
  for (int a = 0; a < angles; ++a) {
    const double v = static_cast<double>(mask ? rest[a].imag() : rest[a].real()) / unit;
    ring[static_cast<std::size_t>(a)] = static_cast<float>(std::clamp(v, -kClip, kClip));
  }
  fourier.forward(ring.data());
  Power power(static_cast<std::size_t>(harmonics) + 1, 0.0);
  const double scale = 2 / (static_cast<double>(angles) * angles);
  for (std::size_t h = 1; h < power.size(); ++h) power[h] = scale * static_cast<double>(std::norm(ring[h]));
  return power;
}

}  // namespace

std::vector<double> period_shares(const Rings& rings, const PartPicture& part, const std::vector<Rings::Sample>& rest,
                                  int most_period) {
  const int angles = rings.angles(), harmonics = std::min(2 * most_period, angles / 2 - 1);
  const Fourier fourier(angles);
  Tally tally(harmonics, most_period);
  for (const bool mask : {false, true}) {
    if (mask && !part.masked) break;
    const double unit = mask ? 1 : std::max(part.contrast, 1e-9);
    std::array<Power, kTogether> last;
    for (int r = 0; r < rings.rings(); ++r) {
      last[static_cast<std::size_t>(r % kTogether)] =
          power_of(rest.data() + rings.offset(r), mask, unit, fourier, angles, harmonics);
      if (r + 1 < kTogether) continue;
      Power mean(static_cast<std::size_t>(harmonics) + 1, 0.0);
      for (const Power& power : last)
        for (std::size_t h = 0; h < mean.size(); ++h) mean[h] += power[h] / kTogether;
      tally.add(mean, 2 * std::numbers::pi * rings.radius(r - 1), mask ? kTeethCover : kTeethGrey);
    }
  }
  return tally.shares();
}

}  // namespace pickcell::matches
