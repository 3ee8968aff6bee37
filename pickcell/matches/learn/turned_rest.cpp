#include "pickcell/matches/learn/turned_rest.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace pickcell::matches {

namespace {

constexpr float kInside = 0.84f;  ///< of the smoothed mask: a pixel from its outline, the ground is no longer seen
constexpr float kTurnedInside = 0.75f;
constexpr float kOutline = 0.1f;       ///< of the smoothed mask: just outside
constexpr double kMarkGrey = 0.12;     ///< of the contrast: what JPEG and grain do is less
constexpr double kMarkNoise = 4.5;     ///< sigmas
constexpr double kMarkGrain = 3.5;     ///< sigmas of what differs everywhere
constexpr double kJumps = 0.12;        ///< of the smoothed mask, by binary outlines
constexpr double kMarkCover = 0.18;    ///< of the smoothed mask: half a pixel, as binary outlines jump
constexpr int kCell_px = 4;            ///< marks are looked for in two by two of these
constexpr double kShift_px = 0.3;      ///< outlines lie this near to where they should ...
constexpr double kShiftShare = 0.004;  ///< ... and this part of the radius: cameras look a little aslant
constexpr double kGreyTells = 4;       ///< of the centre, times what the mask does: a mask may be painted by hand

using Normal = Eigen::Matrix<double, 6, 6>;
using Columns = Eigen::Matrix<double, 6, 1>;
using Sample = Rings::Sample;

/// One ring of the part, of the mean of its turns, and of what may explain their difference.
struct RingOfTurns {
  void resize(int n) {
    light_and_shift.resize(n, 6);
    cover_shift.resize(n, 2);
    grey.resize(n);
    cover.resize(n);
  }

  Eigen::Matrix<float, Eigen::Dynamic, 6> light_and_shift;  ///< of grey, by column
  Eigen::Matrix<float, Eigen::Dynamic, 2> cover_shift;
  Eigen::VectorXf grey, cover;  ///< part less mean
};

class Comparison {
 public:
  Comparison(const Rings& rings, const PartPicture& part, int period) : rings_(rings), part_(part) {
    rings.mean_of_turns(period, mean_);
    share_ = period == 0 ? 1 : 1 - 1.0 / period;
    whole_ = period == 0;
  }

  /// Takes from the differences what explains them without breaking the symmetry: of grey, a light (offset and gain)
  /// that changes along x and y, and a shift; of the mask a shift.
  void explain(TurnedRest& out) {
    Normal normal = Normal::Identity() * 1e-6;
    Columns right = Columns::Zero();
    Eigen::Matrix2d cover_normal = Eigen::Matrix2d::Identity() * 1e-6;
    Eigen::Vector2d cover_right = Eigen::Vector2d::Zero();
    level_ = mean_inside();
    for (int r = 0; r < rings_.rings(); ++r) {
      read(r);
      const auto& v = ring_.light_and_shift;
      normal += area(r) * (v.transpose() * v).cast<double>();
      right += area(r) * (v.transpose() * ring_.grey).cast<double>();
      if (!part_.masked) continue;
      cover_normal += area(r) * (ring_.cover_shift.transpose() * ring_.cover_shift).cast<double>();
      cover_right += area(r) * (ring_.cover_shift.transpose() * ring_.cover).cast<double>();
    }
    const Columns grey = normal.ldlt().solve(right);
    const Eigen::Vector2d cover = cover_normal.ldlt().solve(cover_right);
    out.rest.resize(mean_.size());
    for (int r = 0; r < rings_.rings(); ++r) {
      read(r);
      ring_.grey -= ring_.light_and_shift * grey.cast<float>();
      if (part_.masked) ring_.cover -= ring_.cover_shift * cover.cast<float>();
      for (int i = 0; i < count(r); ++i)
        out.rest[rings_.offset(r) + static_cast<std::size_t>(i * stride(r))] = Sample(ring_.grey[i], ring_.cover[i]);
    }
    const double unit = std::max(1.0, part_.contrast);
    const Eigen::Matrix2d told = kGreyTells / (unit * unit) * normal.bottomRightCorner<2, 2>();
    const Eigen::Vector2d shift = (told + cover_normal).ldlt().solve(told * grey.tail<2>() + cover_normal * cover);
    out.dx = -shift.x();
    out.dy = -shift.y();
  }

  void measure(TurnedRest& out) const {
    double area_all = 0, sum = 0, sum_sq = 0, inside_all = 0, seen = 0, rest_sq = 0, cover = 0, uncovered = 0;
    std::vector<float> sizes;
    for (int r = 0; r < rings_.rings(); ++r)
      for (int a = 0; a < rings_.angles(); a += stride(r)) {
        const double w = area(r);
        const Sample here = rings_.ring(r)[a], rest = out.rest[rings_.offset(r) + static_cast<std::size_t>(a)];
        if (here.imag() >= (part_.masked ? kOutline : 0.5f)) {
          const double v = static_cast<double>(here.real());
          area_all += w;
          sum += w * v;
          sum_sq += w * v * v;
        }
        seen += here.imag() >= (part_.masked ? kInside : 0.5f) ? w : 0;
        if (inside(r, a)) {
          inside_all += w;
          rest_sq += w * static_cast<double>(rest.real() * rest.real());
          if (a / stride(r) % 4 == 0) sizes.push_back(std::abs(rest.real()));
        }
        cover += w * static_cast<double>(here.imag());
        uncovered += w * std::max(0.0, static_cast<double>(std::abs(rest.imag())) - kJumps * share_);
      }
    const double variance = area_all > 0 ? sum_sq / area_all - (sum / area_all) * (sum / area_all) : 0;
    const double noise_sq = part_.noise * part_.noise;
    const double rest_variance = inside_all > 0 ? std::max(0.0, rest_sq / inside_all / share_ - noise_sq) : 0;
    out.compared = seen > 0 ? inside_all / seen : 1;
    out.unlike = std::min(1.0, rest_variance / std::max(variance, noise_sq));
    out.uncovered = part_.masked && cover > 0 ? std::min(1.0, uncovered / cover) : 0;
    out.mark_px = marked(out, 1.4826 * median(sizes) / std::sqrt(share_));
  }

 private:
  [[nodiscard]] const Sample& mean(int ring, int angle) const {
    return mean_[rings_.offset(ring) + static_cast<std::size_t>(angle)];
  }
  [[nodiscard]] bool inside(int ring, int angle) const {
    return part_.masked ? rings_.ring(ring)[angle].imag() >= kInside && mean(ring, angle).imag() >= kTurnedInside
                        : rings_.ring(ring)[angle].imag() >= 0.99f && mean(ring, angle).imag() >= 0.99f;
  }
  /// Of the samples of inner rings, which are less than a pixel apart, each stride-th says enough.
  [[nodiscard]] int stride(int ring) const {
    return whole_ ? 1
                  : std::max(1, static_cast<int>(std::bit_floor(
                                    static_cast<unsigned>(rings_.angles() / (2 * std::numbers::pi * (ring + 1))))));
  }
  [[nodiscard]] int count(int ring) const { return rings_.angles() / stride(ring); }
  /// Of a sample; rings are a pixel wide.
  [[nodiscard]] double area(int ring) const { return 2 * std::numbers::pi * rings_.radius(ring) / count(ring); }

  [[nodiscard]] double mean_inside() const {
    double sum = 0, weight = 0;
    for (int r = 0; r < rings_.rings(); ++r)
      for (int a = 0; a < rings_.angles(); a += stride(r))
        if (inside(r, a)) {
          sum += area(r) * static_cast<double>(mean(r, a).real());
          weight += area(r);
        }
    return weight > 0 ? sum / weight : 0;
  }

  /// Along x (real) and y (imaginary part); of grey and of cover.
  struct Slopes {
    Sample grey, cover;
  };
  [[nodiscard]] Slopes slopes(int ring, int angle) const {
    const int last = rings_.angles() - 1, in = std::max(0, ring - 1), out = std::min(rings_.rings() - 1, ring + 1);
    const double arc = 2 * std::numbers::pi * rings_.radius(ring) / rings_.angles();
    const int step = std::clamp(static_cast<int>(std::lround(1 / arc)), 1, rings_.angles() / 8);
    const Sample radial = (mean(out, angle) - mean(in, angle)) * (1.0f / static_cast<float>(std::max(1, out - in)));
    const Sample along = (mean(ring, (angle + step) & last) - mean(ring, (angle - step) & last)) *
                         static_cast<float>(1 / (2 * step * arc));
    const float c = rings_.direction(angle).real(), s = rings_.direction(angle).imag();
    return {{c * radial.real() - s * along.real(), s * radial.real() + c * along.real()},
            {c * radial.imag() - s * along.imag(), s * radial.imag() + c * along.imag()}};
  }

  void read(int ring) {
    const auto r = static_cast<float>(rings_.radius(ring) / rings_.rings()), level = static_cast<float>(level_);
    ring_.resize(count(ring));
    for (int i = 0; i < count(ring); ++i) {
      const int a = i * stride(ring);
      const Sample differ = rings_.ring(ring)[a] - mean(ring, a);
      const Slopes slope = slopes(ring, a);
      ring_.cover[i] = part_.masked ? differ.imag() : 0;
      ring_.cover_shift.row(i) << slope.cover.real(), slope.cover.imag();
      if (!inside(ring, a)) {
        ring_.light_and_shift.row(i).setZero();
        ring_.grey[i] = 0;
        continue;
      }
      const float x = r * rings_.direction(a).real(), y = r * rings_.direction(a).imag();
      const float grey = mean(ring, a).real() - level;
      ring_.light_and_shift.row(i) << x, y, x * grey, y * grey, slope.grey.real(), slope.grey.imag();
      ring_.grey[i] = differ.real();
    }
  }

  [[nodiscard]] static double median(std::vector<float>& values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return static_cast<double>(*middle);
  }

  /// The largest area within a few pixels that differs by more than noise, grain and an outline a little aside
  /// explain.
  [[nodiscard]] double marked(const TurnedRest& out, double grain) const {
    const double aside_px = kShift_px + kShiftShare * rings_.rings();
    const double limit = std::max({kMarkGrey * part_.contrast, kMarkNoise * part_.noise, kMarkGrain * grain});
    std::vector<double> before, cells;  // areas along the ring of cells inside this one, and along this one
    double most = 0;
    for (int r = 0; r < rings_.rings(); ++r) {
      if (r % kCell_px == 0) {
        before = cells;
        cells.assign(std::max<std::size_t>(1, static_cast<std::size_t>(2 * std::numbers::pi * r / kCell_px)), 0.0);
      }
      for (int a = 0; a < rings_.angles(); a += stride(r)) {
        const Sample rest = out.rest[rings_.offset(r) + static_cast<std::size_t>(a)];
        const double grey = static_cast<double>(std::abs(rest.real())) / share_;
        const double cover = static_cast<double>(std::abs(rest.imag())) / share_;
        if (grey <= limit && cover <= kMarkCover) continue;
        const Slopes slope = slopes(r, a);
        if (grey <= limit + aside_px * static_cast<double>(std::abs(slope.grey)) &&
            cover <= kMarkCover + aside_px * static_cast<double>(std::abs(slope.cover)))
          continue;
        const auto cell = [&](const std::vector<double>& ring) {
          return static_cast<std::size_t>(a) * ring.size() / static_cast<std::size_t>(rings_.angles());
        };
        const std::size_t at = cell(cells);
        cells[at] += area(r);
        double around = cells[at] + cells[(at + 1) % cells.size()];
        if (!before.empty()) {
          const std::size_t in = cell(before);
          around += before[in] + before[(in + 1) % before.size()];
        }
        most = std::max(most, around);
      }
    }
    return most;
  }

  const Rings& rings_;
  const PartPicture& part_;
  RingOfTurns ring_;
  std::vector<Sample> mean_;
  double share_ = 1;  ///< of the difference between the part and one turn, that to the mean of all turns shows
  double level_ = 0;
  bool whole_ = false;
};

}  // namespace

TurnedRest compare_turns(const Rings& rings, const PartPicture& part, int period) {
  TurnedRest out;
  Comparison comparison(rings, part, period);
  comparison.explain(out);
  comparison.measure(out);
  return out;
}

}  // namespace pickcell::matches
