/// pickcell experiment outline: how exact engine best is, and how honest its covariance, for parts that end inside
/// their template and lie on grounds that are not the taught one, with masks at the outline, too large and too small.

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "pickcell/cli/experiment/blob_scene.hpp"
#include "pickcell/cli/experiment/experiment.hpp"
#include "pickcell/cli/experiment/outline_scene.hpp"
#include "pickcell/cli/experiment/pose_finder.hpp"
#include "pickcell/core/file.hpp"
#include "pickcell/core/json.hpp"

namespace pickcell::cli {

namespace {

constexpr int kPosesPerPart = 8;
constexpr int kFewestPoses = 20;  // of a row that is judged

/// The parts are of grey 125: of most pairs one is darker than they, the other brighter.
struct Grounds {
  Ground taught, found;
};
constexpr std::array<Grounds, 5> kGrounds{
    {{{50, 0}, {205, 0}}, {{205, 0}, {50, 0}}, {{50, 0}, {200, 25}}, {{205, 0}, {55, 25}}, {{60, 25}, {60, 25}}}};

constexpr int kMasks = 3;
constexpr std::array<double, kMasks> kOutside_px{0, 2, -2};  // thin parts: half of it
constexpr std::array<const char*, kMasks> kMaskNames{"", ", 2 px too large", ", 2 px too small"};

/// One kind of part with one kind of mask; until finish() sums.
struct Row {
  std::string name;
  int poses = 0, missed = 0;
  PoseError bias = PoseError::Zero();    ///< mean error in the part's own directions
  PoseError spread = PoseError::Zero();  ///< root of the mean square error
  PoseError stated = PoseError::Zero();  ///< root of the mean variance
  PoseError each = PoseError::Zero();    ///< mean normalised squared errors
  double nees = 0;                       ///< of all four together, over the dimension: 1 when the covariance is right

  void add(const PoseError& e, const Eigen::Matrix4d& covariance, double angle_deg) {
    const double a = angle_deg * std::numbers::pi / 180, c = std::cos(a), s = std::sin(a);
    const PoseError own(c * e[0] - s * e[1], s * e[0] + c * e[1], e[2], e[3]);
    ++poses;
    bias += own;
    spread += own.cwiseProduct(own);
    stated += covariance.diagonal();
    each += e.cwiseProduct(e).cwiseQuotient(covariance.diagonal());
    nees += e.dot(covariance.inverse() * e) / 4;
  }
  void finish() {
    const double n = std::max(1, poses);
    bias /= n;
    spread = (spread / n).cwiseSqrt();
    stated = (stated / n).cwiseSqrt();
    each /= n;
    nees /= n;
  }
  [[nodiscard]] bool honest() const { return poses < kFewestPoses || (nees >= 0.5 && nees <= 2); }
  [[nodiscard]] std::string line() const {
    char text[300];
    std::snprintf(text, sizeof text,
                  "%-26s %5d %6d | %+.4f %+.4f %+.4f %+.3f | %.4f %.4f %.4f %.3f | %.4f %.4f %.4f %.3f | %5.2f (%.2f "
                  "%.2f %.2f %.2f)\n",
                  name.c_str(), poses, missed, bias[0], bias[1], bias[2], 100 * bias[3], spread[0], spread[1],
                  spread[2], 100 * spread[3], stated[0], stated[1], stated[2], 100 * stated[3], nees, each[0], each[1],
                  each[2], each[3]);
    return text;
  }
  [[nodiscard]] core::Json json() const {
    core::Json j;
    j.set("name", name).set("poses", poses).set("missed", missed).set("nees", nees);
    j.set("bias_x_px", bias[0]).set("bias_y_px", bias[1]).set("bias_deg", bias[2]).set("bias_scale", bias[3]);
    j.set("rms_x_px", spread[0]).set("rms_y_px", spread[1]).set("rms_deg", spread[2]).set("rms_scale", spread[3]);
    j.set("stated_x_px", stated[0]).set("stated_y_px", stated[1]).set("stated_deg", stated[2]);
    j.set("stated_scale", stated[3]);
    return j;
  }
};

/// One kind with every mask: the same parts, poses and pictures.
std::array<Row, kMasks> rows_of(OutlineKind kind, int poses, std::mt19937_64& rng) {
  std::uniform_real_distribution<double> unit(0, 1);
  std::array<Row, kMasks> rows;
  for (int i = 0; i < poses;) {
    const int side_px = 80 + static_cast<int>(50 * unit(rng));
    const OutlineScene scene(kind, side_px, rng());
    const Grounds& grounds = kGrounds[static_cast<std::size_t>(i / kPosesPerPart) % kGrounds.size()];
    std::vector<PoseFinder> finders;
    for (const double outside_px : kOutside_px)
      finders.emplace_back(scene.model(grounds.taught, kind == OutlineKind::thin ? outside_px / 2 : outside_px));
    for (int p = 0; p < kPosesPerPart && i < poses; ++p, ++i) {
      matches::Pose2d truth;
      truth.x_px = OutlineScene::kWidth / 2.0 + 20 * unit(rng) - 10;
      truth.y_px = OutlineScene::kHeight / 2.0 + 20 * unit(rng) - 10;
      truth.angle_deg = 360 * unit(rng) - 180;
      truth.scale = 0.92 + 0.16 * unit(rng);
      const double noise_grey = 1 + 7 * unit(rng);
      const image::Image picture = BlobScene::expose(scene.draw(truth, grounds.found), noise_grey, rng);
      for (std::size_t m = 0; m < kMasks; ++m) {
        PoseError e;
        Eigen::Matrix4d covariance;
        if (finders[m].find(picture, truth, e, covariance))
          rows[m].add(e, covariance, truth.angle_deg);
        else
          ++rows[m].missed;
      }
    }
  }
  for (std::size_t m = 0; m < kMasks; ++m) {
    rows[m].name = std::string(name(kind)) + kMaskNames[m];
    rows[m].finish();
  }
  return rows;
}

core::Result<int> run(const ExperimentOptions& options, Io& io) {
  std::mt19937_64 rng(options.seed);
  std::string text =
      "part, mask                 poses missed | bias x px, y px, degrees, scale % | root mean square | stated | "
      "normalised squared error (each)\n";
  core::Json all = core::Json::array();
  bool honest = true;
  for (int k = 0; k < kOutlineKinds; ++k)
    for (const Row& row : rows_of(static_cast<OutlineKind>(k), options.n.value_or(1000), rng)) {
      honest = honest && row.honest();
      text += row.line();
      all.push(row.json());
    }
  if (auto written = core::write_file_atomically(options.out / "outline.txt", text); !written)
    return core::forward(written);
  if (options.json) {
    core::Json json;
    json.set("rows", std::move(all));
    io.out << json.dump() << "\n";
  } else {
    io.out << text;
  }
  return honest ? 0 : 1;
}

const ExperimentRegistration kRegistered({"outline",
                                          "exactness and covariance of engine best for masked parts on grounds that "
                                          "are not the taught one (--n poses of each kind, default 1000)",
                                          false, run});

}  // namespace

}  // namespace pickcell::cli
