/// pickcell experiment trueness: how exact engine best is where the truth is known to any digit, and whether its
/// covariance says so. Steps of 0.05 px and 0.05 degrees (bias, locking to pixels), exposures of one scene
/// (repeatability), random poses under noise (normalised squared errors).

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <ostream>
#include <random>

#include "pickcell/cli/experiment/blob_scene.hpp"
#include "pickcell/cli/experiment/experiment.hpp"
#include "pickcell/cli/experiment/pose_finder.hpp"
#include "pickcell/core/file.hpp"
#include "pickcell/core/json.hpp"

namespace pickcell::cli {

namespace {

constexpr int kWidth = 320, kHeight = 240, kSide = 90;
constexpr double kNoise_grey = 4;
constexpr int kExposures = 100;

using Error = PoseError;

struct Spread {
  double bias = 0;
  double p95 = 0;      ///< of |error|
  double locking = 0;  ///< amplitude of the error's part that repeats with every pixel (or degree)
  int missed = 0;
};

Spread spread_of(const std::vector<double>& errors, const std::vector<double>& phase, int missed) {
  Spread s;
  s.missed = missed;
  double c = 0, q = 0;
  std::vector<double> size;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    s.bias += errors[i] / static_cast<double>(errors.size());
    size.push_back(std::abs(errors[i]));
  }
  for (std::size_t i = 0; i < errors.size(); ++i) {
    c += (errors[i] - s.bias) * std::cos(2 * std::numbers::pi * phase[i]);
    q += (errors[i] - s.bias) * std::sin(2 * std::numbers::pi * phase[i]);
  }
  s.locking = 2 * std::hypot(c, q) / static_cast<double>(std::max<std::size_t>(1, errors.size()));
  std::sort(size.begin(), size.end());
  if (!size.empty()) s.p95 = size[static_cast<std::size_t>(0.95 * static_cast<double>(size.size() - 1))];
  return s;
}

/// 100 steps along one direction, without noise. which: 0 x, 1 y, 2 angle.
Spread steps(const BlobScene& scene, PoseFinder& finder, int which, std::mt19937_64& rng) {
  std::vector<double> errors, phase;
  int missed = 0;
  for (int i = 0; i < 100; ++i) {
    matches::Pose2d truth{kWidth / 2.0, kHeight / 2.0, 17.3, 1.02};
    const double step = 0.05 * i;
    (which == 0 ? truth.x_px : which == 1 ? truth.y_px : truth.angle_deg) += step;
    Error e;
    Eigen::Matrix4d unused;
    if (!finder.find(BlobScene::expose(scene.draw(truth), 0, rng), truth, e, unused)) {
      ++missed;
      continue;
    }
    errors.push_back(e[which]);
    phase.push_back(step);
  }
  return spread_of(errors, phase, missed);
}

struct Repeatability {
  Error sigma = Error::Zero(), stated = Error::Zero();
};

Repeatability repeat(const BlobScene& scene, PoseFinder& finder, std::mt19937_64& rng) {
  const matches::Pose2d truth{kWidth / 2.0 + 0.37, kHeight / 2.0 - 0.21, 33.3, 0.97};
  const image::Plane<float> light = scene.draw(truth);
  Error sum = Error::Zero(), square = Error::Zero();
  Repeatability r;
  int n = 0;
  for (int i = 0; i < kExposures; ++i) {
    Error e;
    Eigen::Matrix4d covariance;
    if (!finder.find(BlobScene::expose(light, kNoise_grey, rng), truth, e, covariance)) continue;
    sum += e;
    square += e.cwiseProduct(e);
    r.stated += covariance.diagonal().cwiseSqrt();
    ++n;
  }
  if (n < 2) return r;
  r.sigma = ((square - sum.cwiseProduct(sum) / n) / (n - 1)).cwiseMax(0).cwiseSqrt();
  r.stated /= n;
  return r;
}

struct Consistency {
  double nees = 0;  ///< mean normalised squared error over the dimension: 1 when the covariance is right
  Error each = Error::Zero();
  int poses = 0, missed = 0;
};

Consistency consistency(int poses, std::uint64_t seed) {
  std::mt19937_64 rng(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  Consistency c;
  for (int i = 0; i < poses;) {
    const BlobScene scene(60 + static_cast<int>(90 * unit(rng)), kWidth, kHeight, rng());
    PoseFinder finder(scene.model());
    for (int k = 0; k < 20 && i < poses; ++k, ++i) {
      const matches::Pose2d truth{kWidth / 2.0 + 20 * unit(rng) - 10, kHeight / 2.0 + 20 * unit(rng) - 10,
                                  360 * unit(rng) - 180, 0.92 + 0.16 * unit(rng)};
      Error e;
      Eigen::Matrix4d covariance;
      const image::Image picture = BlobScene::expose(scene.draw(truth), 1 + 7 * unit(rng), rng);
      if (!finder.find(picture, truth, e, covariance)) {
        ++c.missed;
        continue;
      }
      ++c.poses;
      c.nees += e.dot(covariance.inverse() * e) / 4;
      c.each += e.cwiseProduct(e).cwiseQuotient(covariance.diagonal());
    }
  }
  c.nees /= std::max(1, c.poses);
  c.each /= std::max(1, c.poses);
  return c;
}

std::string line(const char* what, const Spread& s, const char* unit) {
  char text[160];
  std::snprintf(text, sizeof text, "%-24s bias %+.4f, 95 %% %.4f, locking %.4f %s, missed %d of 100\n", what, s.bias,
                s.p95, s.locking, unit, s.missed);
  return text;
}

std::string table(const std::array<Spread, 3>& s, const Repeatability& r, const Consistency& c) {
  char text[500];
  std::snprintf(
      text, sizeof text,
      "repeatability            sigma %.4f px %.4f px %.4f deg %.5f scale (noise %.0f grey, %d exposures)\n"
      "  stated by the matcher        %.4f px %.4f px %.4f deg %.5f scale\n"
      "normalised squared error %.2f per dimension over %d noisy poses (x %.2f, y %.2f, angle %.2f, scale %.2f),"
      " missed %d\n",
      r.sigma[0], r.sigma[1], r.sigma[2], r.sigma[3], kNoise_grey, kExposures, r.stated[0], r.stated[1], r.stated[2],
      r.stated[3], c.nees, c.poses, c.each[0], c.each[1], c.each[2], c.each[3], c.missed);
  return line("x in steps of 0.05 px", s[0], "px") + line("y in steps of 0.05 px", s[1], "px") +
         line("angle, steps of 0.05 deg", s[2], "deg") + text;
}

core::Result<int> run(const ExperimentOptions& options, Io& io) {
  const BlobScene scene(kSide, kWidth, kHeight, options.seed);
  PoseFinder finder(scene.model());
  std::mt19937_64 rng(options.seed);
  const std::array<Spread, 3> s{steps(scene, finder, 0, rng), steps(scene, finder, 1, rng),
                                steps(scene, finder, 2, rng)};
  const Repeatability r = repeat(scene, finder, rng);
  const Consistency c = consistency(options.n.value_or(1000), options.seed + 1);
  const std::string text = table(s, r, c);
  if (auto written = core::write_file_atomically(options.out / "trueness.txt", text); !written)
    return core::forward(written);
  if (options.json) {
    core::Json json;
    json.set("bias_x_px", s[0].bias).set("p95_x_px", s[0].p95).set("locking_x_px", s[0].locking);
    json.set("bias_y_px", s[1].bias).set("p95_y_px", s[1].p95).set("locking_y_px", s[1].locking);
    json.set("bias_deg", s[2].bias).set("p95_deg", s[2].p95).set("locking_deg", s[2].locking);
    json.set("sigma_x_px", r.sigma[0]).set("sigma_y_px", r.sigma[1]).set("sigma_deg", r.sigma[2]);
    json.set("sigma_scale", r.sigma[3]).set("nees", c.nees).set("poses", c.poses).set("missed", c.missed);
    io.out << json.dump() << "\n";
  } else {
    io.out << text;
  }
  const bool consistent = c.nees >= 0.5 && c.nees <= 2;
  return consistent && c.missed * 100 <= c.poses ? 0 : 1;
}

const ExperimentRegistration kRegistered({"trueness",
                                          "exactness of engine best on known poses, and whether its "
                                          "covariance is right (--n noisy poses, default 1000)",
                                          false, run});

}  // namespace

}  // namespace pickcell::cli
