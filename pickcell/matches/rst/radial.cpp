#include "pickcell/matches/rst/radial.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "pickcell/matches/rst/kernels.hpp"
#include "pickcell/matches/rst/radial_kernels.hpp"

namespace pickcell::matches {
namespace {

constexpr int kMidGrey = static_cast<int>(kRadialUnit * 127.5f);
constexpr int kMostLines = 360;

int padded(int lines) { return (lines + kRstBlock - 1) / kRstBlock * kRstBlock; }

/// Where in the doubled query the template turned by `shift` lines begins.
int start_of(int shift, int lines) { return (lines - shift) % lines; }

double ncc_of(std::int64_t n, std::int64_t x, std::int64_t xx, std::int64_t y, std::int64_t yy, std::int64_t xy) {
  const std::int64_t query = n * xx - x * x, scene = n * yy - y * y;
  if (query <= 0 || scene <= 0) return -2;
  return static_cast<double>(n * xy - x * y) / std::sqrt(static_cast<double>(query) * static_cast<double>(scene));
}

struct BestDot {
  int shift = 0;
  std::int64_t value = 0;  ///< N * dot - sum * sum
  bool any = false;
};

/// By which turns are compared.
std::int64_t value_of(const RadialQuery& query, const RadialFeatures& f, std::int32_t product, bool negative) {
  const std::int64_t centred = query.lines * static_cast<std::int64_t>(product) - query.sum * f.sum;
  return negative ? std::abs(centred) : centred;
}

/// Looks at some turns in order; ties go to the first.
void look(const RadialQuery& query, const RadialFeatures& f, std::span<const int> shifts, bool negative,
          BestDot& best) {
  std::array<int, kMostLines> starts;
  std::array<std::int32_t, kMostLines> product;
  for (std::size_t i = 0; i < shifts.size(); ++i) starts[i] = start_of(shifts[i], query.lines);
  dots(f.values.data(), query.doubled.data(), padded(query.lines), {starts.data(), shifts.size()}, product.data());
  for (std::size_t i = 0; i < shifts.size(); ++i) {
    const std::int64_t value = value_of(query, f, product[i], negative);
    if (!best.any || value > best.value) best = {shifts[i], value, true};
  }
}

/// Looks at the turns 0, 2, 4, ..; their number. Turn m begins at n - m of the doubled query, so that the last of them
/// comes first; ties go to the smallest.
int look_at_every_second(const RadialQuery& query, const RadialFeatures& f, bool negative, BestDot& best) {
  const int n = query.lines, count = (n + 1) / 2, last = 2 * (count - 1);
  std::array<std::int32_t, kMostLines> product;
  stepped_dots(f.values.data(), query.doubled.data() + n - last, count, count, product.data());
  int at = 0;
  if (negative) {
    for (int t = 1; t < count; ++t)
      if (value_of(query, f, product[static_cast<std::size_t>(t)], true) >=
          value_of(query, f, product[static_cast<std::size_t>(at)], true))
        at = t;
  } else {  // the product alone decides; without branches, as any turn may be the best
    std::int32_t top = product[0];
    for (int t = 1; t < count; ++t) {
      const std::int32_t here = product[static_cast<std::size_t>(t)];
      at = here >= top ? t : at;
      top = here >= top ? here : top;
    }
  }
  best = {last - 2 * at, value_of(query, f, product[static_cast<std::size_t>(at)], negative), true};
  return count;
}

ShiftScore normalised(const RadialQuery& query, const RadialFeatures& f, const BestDot& best, int compared) {
  const std::int64_t n = query.lines;
  const std::int64_t q = n * query.sum_sq - query.sum * query.sum, s = n * f.sum_sq - f.sum * f.sum;
  ShiftScore out{best.shift, -2, compared};
  if (best.any && q > 0 && s > 0)
    out.ncc = static_cast<double>(best.value) / std::sqrt(static_cast<double>(q) * static_cast<double>(s));
  return out;
}

}  // namespace

RadialQuery make_radial_query(std::span<const float> means) {
  RadialQuery out;
  out.lines = static_cast<int>(means.size());
  const float mean = std::accumulate(means.begin(), means.end(), 0.f) / static_cast<float>(means.size());
  const std::size_t n = means.size();
  out.doubled.assign(2 * n + static_cast<std::size_t>(padded(out.lines)), 0);
  for (std::size_t j = 0; j < n; ++j) {
    const auto v = static_cast<std::int16_t>(std::lround(kRadialUnit * (means[j] - mean)));
    out.doubled[j] = out.doubled[j + n] = v;
    out.sum += v;
    out.sum_sq += static_cast<std::int64_t>(v) * v;
  }
  return out;
}

void set_radial_features(const float* means, std::ptrdiff_t stride, int lines, RadialFeatures& out) {
  out.values.resize(static_cast<std::size_t>(padded(lines)), 0);
  out.sum = out.sum_sq = 0;
  for (int j = 0; j < lines; ++j) {
    // Grey values are not negative, so cutting rounds down.
    const auto v = static_cast<std::int16_t>(static_cast<int>(kRadialUnit * means[j * stride] + 0.5f) - kMidGrey);
    out.values[static_cast<std::size_t>(j)] = v;
    out.sum += v;
    out.sum_sq += static_cast<std::int64_t>(v) * v;
  }
}

ShiftScore shift_by_ncc(const RadialQuery& query, const RadialFeatures& f, const AllowedShifts& allowed,
                        bool negative) {
  const int n = query.lines, size = padded(n);
  std::vector<std::int16_t> turned(static_cast<std::size_t>(size), 0), ones(turned);
  std::fill_n(ones.begin(), n, std::int16_t{1});
  const int zero[] = {0};
  const auto sum_of = [&](const std::vector<std::int16_t>& a, const std::vector<std::int16_t>& b) {
    std::int32_t out = 0;
    dots(a.data(), b.data(), size, zero, &out);
    return static_cast<std::int64_t>(out);
  };
  ShiftScore best;
  const int count = allowed.empty() ? n : static_cast<int>(allowed.size());
  for (int i = 0; i < count; ++i) {
    const int shift = allowed.empty() ? i : allowed[static_cast<std::size_t>(i)];
    std::copy_n(query.doubled.begin() + start_of(shift, n), n, turned.begin());
    double ncc = ncc_of(n, sum_of(turned, ones), sum_of(turned, turned), sum_of(f.values, ones),
                        sum_of(f.values, f.values), sum_of(turned, f.values));
    if (negative && ncc > -2) ncc = std::abs(ncc);
    if (ncc > best.ncc) best = {shift, ncc, 0};
  }
  best.compared = count;
  return best;
}

ShiftScore shift_by_dot(const RadialQuery& query, const RadialFeatures& f, const AllowedShifts& allowed,
                        bool negative) {
  const int n = query.lines;
  BestDot best;
  if (!allowed.empty()) {
    look(query, f, allowed, negative, best);
    return normalised(query, f, best, static_cast<int>(allowed.size()));
  }
  const int count = look_at_every_second(query, f, negative, best);
  const int beside[] = {(best.shift + n - 1) % n, (best.shift + 1) % n};
  look(query, f, beside, negative, best);
  return normalised(query, f, best, count + 2);
}

ShiftScore shift_by_every_dot(const RadialQuery& query, const RadialFeatures& f, bool negative) {
  AllowedShifts all(static_cast<std::size_t>(query.lines));
  std::iota(all.begin(), all.end(), 0);
  return shift_by_dot(query, f, all, negative);
}

}  // namespace pickcell::matches
