#include "pickcell/sim/rendered_set.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "pickcell/core/file.hpp"
#include "pickcell/core/json.hpp"
#include "pickcell/core/units.hpp"
#include "pickcell/image/codec.hpp"
#include "pickcell/sim/flat_scene.hpp"

namespace pickcell::sim {
namespace {

namespace fs = std::filesystem;

struct Folder {
  fs::path path = fs::temp_directory_path() / ("pickcell_rendered_" + std::to_string(::getpid()) + "_" +
                                               ::testing::UnitTest::GetInstance()->current_test_info()->name());
  ~Folder() { fs::remove_all(path); }
};

core::Json truth_of(const fs::path& folder) {
  const auto text = core::read_text_file(folder / "truth.json");
  EXPECT_TRUE(text);
  return core::parse_json(*text, "truth").value();
}

double at(const image::Image& image, double x, double y) {
  const int ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
  const double u = x - ix, v = y - iy;
  return (1 - v) * ((1 - u) * image.at(ix, iy) + u * image.at(ix + 1, iy)) +
         v * ((1 - u) * image.at(ix, iy + 1) + u * image.at(ix + 1, iy + 1));
}

/// Masked correlation of a template laid into a picture by the convention of the interface.
double correlation(const image::Image& scene, const image::Image& part, const image::Image& mask, double x, double y,
                   double angle_deg, double scale) {
  const double c = std::cos(core::rad_from_deg(angle_deg)), s = std::sin(core::rad_from_deg(angle_deg));
  double n = 0, st = 0, ss = 0, stt = 0, sss = 0, sts = 0;
  for (int ty = 0; ty < part.height(); ++ty)
    for (int tx = 0; tx < part.width(); ++tx) {
      if (mask.at(tx, ty) < 128) continue;
      const double dx = tx - 0.5 * (part.width() - 1), dy = ty - 0.5 * (part.height() - 1);
      const double v = at(scene, x + scale * (c * dx + s * dy), y + scale * (-s * dx + c * dy)), t = part.at(tx, ty);
      n += 1, st += t, ss += v, stt += t * t, sss += v * v, sts += t * v;
    }
  return (n * sts - st * ss) / std::sqrt((n * stt - st * st) * (n * sss - ss * ss));
}

/// Where the parabola through the values at -step, 0, step has its top.
double top_of(double left, double middle, double right, double step) {
  return step * 0.5 * (left - right) / (left - 2 * middle + right);
}

TEST(RenderedSet, TemplatesLieWhereTheTruthSays) {
  const Folder folder;
  ASSERT_TRUE(write_rendered_set(folder.path, 5, 45));
  const core::Json truth = truth_of(folder.path);
  const core::Json& images = truth["images"];
  // Light that stays while the part turns pulls single pictures by a fraction of a pixel, but not all to one side.
  double sum_x = 0, sum_y = 0, sum_a = 0;
  int checked = 0;
  for (const core::Json& entry : images.items()) {
    if (entry["kind"].string() != "clean") continue;
    const std::string id = entry["template"].string(), file = entry["file"].string();
    const auto scene = image::load_grey(folder.path / file);
    const auto part = image::load_grey(folder.path / "templates" / (id + ".png"));
    const auto mask = image::load_grey(folder.path / "templates" / (id + "_mask.png"));
    ASSERT_TRUE(scene && part && mask);
    const double x = *entry["x"].number(), y = *entry["y"].number(), a = *entry["angle"].number(),
                 s = *entry["scale"].number();
    const auto ncc = [&](double dx, double dy, double da) {
      return correlation(*scene, *part, *mask, x + dx, y + dy, a + da, s);
    };
    const double peak = ncc(0, 0, 0);
    const double off_x = top_of(ncc(-1, 0, 0), peak, ncc(1, 0, 0), 1),
                 off_y = top_of(ncc(0, -1, 0), peak, ncc(0, 1, 0), 1);
    const double off_a = top_of(ncc(0, 0, -1), peak, ncc(0, 0, 1), 1);
    EXPECT_GT(peak, 0.8) << file;
    EXPECT_LT(std::hypot(off_x, off_y), 0.4) << file;
    EXPECT_LT(std::abs(off_a), 0.3) << file;
    sum_x += off_x, sum_y += off_y, sum_a += off_a;
    ++checked;
  }
  ASSERT_EQ(checked, 9);
  EXPECT_NEAR(sum_x / checked, 0, 0.12);
  EXPECT_NEAR(sum_y / checked, 0, 0.12);
  EXPECT_NEAR(sum_a / checked, 0, 0.08);
}

TEST(RenderedSet, SameSeedSameBytes) {
  const Folder folder;
  for (const char* run : {"a", "b"}) ASSERT_TRUE(write_rendered_multi_set(folder.path / run, 9, 2));
  ASSERT_TRUE(write_rendered_multi_set(folder.path / "c", 10, 1));
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder.path / "a")) {
    if (!entry.is_regular_file()) continue;
    const fs::path name = fs::relative(entry.path(), folder.path / "a");
    EXPECT_EQ(core::read_file(entry.path()).value(), core::read_file(folder.path / "b" / name).value()) << name;
    ++files;
  }
  EXPECT_GE(files, 2 * 15 + 2 + 1);
  EXPECT_NE(core::read_file(folder.path / "a/truth.json").value(),
            core::read_file(folder.path / "c/truth.json").value());
}

TEST(RenderedSet, InstancesLieInThePictureAndAbsentOnesAreSaid) {
  const Folder folder;
  ASSERT_TRUE(write_rendered_multi_set(folder.path, 3, 10));
  const core::Json truth = truth_of(folder.path);
  const core::Json& images = truth["images"];
  ASSERT_EQ(images.items().size(), 10U);
  int absent = 0;
  for (const core::Json& entry : images.items()) {
    const auto& instances = entry["instances"].items();
    absent += instances.empty() ? 1 : 0;
    EXPECT_LE(instances.size(), 7U);
    EXPECT_NE(instances.size(), 1U);
    for (const core::Json& pose : instances) {
      EXPECT_TRUE(*pose["x"].number() > 10 && *pose["x"].number() < 758);
      EXPECT_TRUE(*pose["y"].number() > 10 && *pose["y"].number() < 566);
      EXPECT_TRUE(*pose["angle"].number() >= 0 && *pose["angle"].number() < 360);
      EXPECT_TRUE(*pose["scale"].number() >= 0.9 && *pose["scale"].number() <= 1.1);
    }
  }
  EXPECT_EQ(absent, 2);
}

TEST(RenderedSet, FolderThatCannotBeWrittenIsAnError) {
  const auto done = write_rendered_set("/proc/nowhere", 1, 1);
  ASSERT_FALSE(done);
  EXPECT_EQ(done.error().code, core::ErrorCode::unreadable);
}

TEST(FlatScene, CoverageKeepsCentreAndArea) {
  const PartTexture& part = part_texture("bracket_l");
  double area = 0;
  Point2 middle = Point2::Zero();
  const Shape& outline = part.kind().outline;
  for (double y = -25.95; y < 26; y += 0.1)
    for (double x = -31.95; x < 32; x += 0.1)
      if (outline.distance({x, y}) < 0) area += 0.01, middle += 0.01 * Point2(x, y);
  middle /= area;
  const FlatPose pose{151.3, 160.8, 37, 3.1, {2, -3}};
  const LightPlane covered = coverage(340, 340, part, pose);
  double sum = 0, sx = 0, sy = 0;
  for (int y = 0; y < covered.height(); ++y)
    for (int x = 0; x < covered.width(); ++x) {
      const double v = static_cast<double>(covered.at(x, y));
      sum += v, sx += v * x, sy += v * y;
    }
  const Point2 d = middle - pose.anchor_mm;
  const double c = std::cos(core::rad_from_deg(37)), s = std::sin(core::rad_from_deg(37));
  EXPECT_NEAR(sum, area * 3.1 * 3.1, 0.01 * sum);
  EXPECT_NEAR(sx / sum, 151.3 + 3.1 * (c * d.x() - s * d.y()), 0.05);
  EXPECT_NEAR(sy / sum, 160.8 - 3.1 * (s * d.x() + c * d.y()), 0.05);
}

TEST(Sensor, BlurKeepsLightAndMotionBlurHasItsLength) {
  LightPlane line(101, 41);
  for (int y = 0; y < 41; ++y) line.at(50, y) = 1;
  LightPlane still(line);
  blur(still, 1.5);
  motion_blur(line, 12, 0);
  const auto moments = [](const LightPlane& p) {
    double sum = 0, first = 0, second = 0;
    for (int x = 0; x < p.width(); ++x) {
      const double v = static_cast<double>(p.at(x, 20));
      sum += v, first += v * x, second += v * x * x;
    }
    return std::array{sum, first / sum, second / sum - first * first / (sum * sum)};
  };
  EXPECT_NEAR(moments(still)[0], 1, 1e-4);
  EXPECT_NEAR(moments(still)[2], 1.5 * 1.5, 0.1);
  EXPECT_NEAR(moments(line)[0], 1, 1e-4);
  EXPECT_NEAR(moments(line)[1], 50, 0.05);
  EXPECT_NEAR(moments(line)[2], 12 * 12 / 12.0, 0.5);  // of a box
}

TEST(Sensor, NoiseHasItsStrengthAndFollowsFromTheSeed) {
  LightPlane grey(200, 200);
  grey.fill(0.5F);
  const image::Image a = expose(grey, {.noise_grey = 4}, 7), b = expose(grey, {.noise_grey = 4}, 7),
                     c = expose(grey, {.noise_grey = 4}, 8);
  double sum = 0, squares = 0;
  int same = 0, other = 0;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) {
      const double v = a.at(x, y);
      sum += v, squares += v * v;
      same += a.at(x, y) == b.at(x, y) ? 1 : 0, other += a.at(x, y) == c.at(x, y) ? 1 : 0;
    }
  EXPECT_NEAR(sum / 40000, 127.5, 0.2);
  EXPECT_NEAR(std::sqrt(squares / 40000 - sum * sum / 1.6e9), 4, 0.15);
  EXPECT_EQ(same, 40000);
  EXPECT_LT(other, 10000);
}

}  // namespace
}  // namespace pickcell::sim
