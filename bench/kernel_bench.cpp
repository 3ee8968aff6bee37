/// The matcher's kernels per SIMD target: items per second, and which fraction of the machine's measured peak for the
/// instructions that the kernel cannot do without (peak.hpp).

#include <benchmark/benchmark.h>

#include <memory>
#include <random>
#include <string>
#include <vector>

#include <hwy/highway.h>

#include "peak.hpp"
#include "pickcell/matches/coarse/kernel.hpp"
#include "pickcell/matches/fields/orientation_field.hpp"
#include "pickcell/matches/fit/contour_kernel.hpp"
#include "pickcell/matches/fit/point_kernels.hpp"
#include "pickcell/matches/rst/kernels.hpp"
#include "pickcell/matches/rst/radial_kernels.hpp"

namespace pickcell::matches {
namespace {

image::Image random_picture(int width, int height) {
  std::mt19937 rng(1);
  image::Image out(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) out.at(x, y) = static_cast<std::uint8_t>(rng() & 255U);
  return out;
}

/// One kernel at work: what a call needs and how much it does.
struct Work {
  std::string name;
  double items;  ///< of one call
  double (*peak)(const bench::Peak&);
  std::function<void()> call;
};

double products(const bench::Peak& p) { return p.products; }
double steps(const bench::Peak& p) { return p.steps; }
double reads(const bench::Peak& p) { return p.reads; }

void add(const std::string& name, double items, double peak, std::int64_t target, std::function<void()> call) {
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& state) {
    hwy::SetSupportedTargetsForTest(target);
    for (auto unused : state) {
      static_cast<void>(unused);
      call();
      benchmark::ClobberMemory();
    }
    hwy::SetSupportedTargetsForTest(0);
    using benchmark::Counter;
    state.counters["items/s"] = Counter(items, Counter::kIsIterationInvariantRate);
    state.counters["of_peak"] = Counter(items / peak, Counter::kIsIterationInvariantRate);
  });
}

/// A block of positions at the size of a quick pass, and larger ones. Items: products of two bytes.
class CoarseLoad {
 public:
  CoarseLoad(int width, int height) : width_(width), height_(height), stride_(width + 64) {
    std::mt19937 rng(1);
    cells_.resize(static_cast<std::size_t>(stride_ * (height + 40)));
    for (auto& c : cells_) c = static_cast<std::uint32_t>(rng());
    for (int k = 0; k < kTaps; ++k) {
      offsets_.push_back(k / 8 * stride_ + 2 * (k % 8));
      for (int i = 0; i < 16; ++i) weights_.push_back(static_cast<std::int8_t>(static_cast<int>(rng() % 201) - 100));
    }
    score_.resize(static_cast<std::size_t>((width + kKernelBlock) * height));
  }
  void run(CoarseKernel kernel) {
    kernel({cells_.data(), stride_, width_, height_}, {offsets_, weights_, {0, 0, 0, 0}, {1, 1, 1, 1}}, score_.data(),
           width_ + kKernelBlock);
  }
  [[nodiscard]] double items() const { return 16.0 * kTaps * width_ * height_; }
  [[nodiscard]] std::string size() const { return std::to_string(width_) + "x" + std::to_string(height_); }

 private:
  static constexpr int kTaps = 80;
  int width_, height_, stride_;
  std::vector<std::uint32_t> cells_;
  std::vector<std::int32_t> offsets_;
  std::vector<std::int8_t> weights_;
  std::vector<float> score_;
};

/// Everything that refinement reads: 512 points of a part 200 px wide.
class PointLoad {
 public:
  PointLoad() : picture_(random_picture(640, 480)) {
    std::mt19937 rng(2);
    std::uniform_real_distribution<float> place(-100, 100), value(-1, 1);
    for (auto* column : {&x_, &y_}) fill(*column, [&] { return place(rng); });
    for (auto* column : {&t_, &j_, &nx_, &ny_, &weight_}) fill(*column, [&] { return value(rng); });
    out_.resize(kPoints);
    orientation_field(picture_.view(), field_);
  }
  static constexpr int kPoints = 512;
  static constexpr LevelMap kMap{320.4f, 240.2f, 0.8f, 0.5f};
  [[nodiscard]] PointColumns points() const {
    return {x_.data(), y_.data(), t_.data(), {j_.data(), nx_.data(), ny_.data(), t_.data()}, kPoints};
  }
  void sum() const { benchmark::DoNotOptimize(sum_points(picture_.view(), points(), kMap)); }
  void sum_weights() const {
    float sums[27];
    sum_weighted(points(), t_.data(), weight_.data(), sums);
    benchmark::DoNotOptimize(sums);
  }
  void sum_field() const {
    benchmark::DoNotOptimize(sum_edges(field_.view(), {x_.data(), y_.data(), t_.data(), j_.data(), kPoints}, kMap));
  }
  void edges(EdgeReading reading) {
    find_edges(picture_.view(), {x_.data(), y_.data(), nx_.data(), ny_.data(), kPoints}, kMap, 2.5f, reading,
               out_.data());
  }
  void field() {
    orientation_field_part(picture_.view(), {64, 64, 64 + kFieldPartWidth, 64 + kFieldPartHeight}, field_);
  }

 private:
  using Column = std::vector<float>;
  template <class Make>
  static void fill(Column& column, const Make& make) {
    column.resize(kPoints);
    for (float& v : column) v = make();
  }
  image::Image picture_;
  OrientationField field_;
  Column x_, y_, t_, j_, nx_, ny_, weight_, out_;
};

/// What the paper's engines spend their time on.
class PaperLoad {
 public:
  PaperLoad()
      : picture_(random_picture(200, 200)), lists_(offsets_for(circle_lists(circle_radii(20, 10)), picture_.stride())) {
    means_.resize(lists_.inverse_length.size() * kPositions);
    a_.resize(384, 3);
    b_.resize(800, 5);
    for (int i = 0; i < 361; i += 10) starts_.push_back(i);
    sums_.resize(starts_.size());
  }
  static constexpr int kPositions = 128;
  void means() { mean_lists(picture_.row(100) + 30, lists_, kPositions, means_.data(), kPositions); }
  void radial() { dots(a_.data(), b_.data(), 384, starts_, sums_.data()); }
  [[nodiscard]] double additions() const { return static_cast<double>(lists_.offsets.size()) * kPositions; }
  [[nodiscard]] double products() const { return 384.0 * static_cast<double>(starts_.size()); }

 private:
  image::Image picture_;
  OffsetLists lists_;
  std::vector<float> means_;
  std::vector<std::int16_t> a_, b_;
  std::vector<int> starts_;
  std::vector<std::int32_t> sums_;
};

/// The kernels that Highway dispatches. Items are those of the peak that bounds the kernel; additions of 16 bits go two
/// to a lane.
std::vector<Work> highway_work() {
  const auto points = std::make_shared<PointLoad>();
  const auto paper = std::make_shared<PaperLoad>();
  constexpr double kPoints = PointLoad::kPoints;
  constexpr double kSamples = 2 * 8 + 1;  // along a normal: 2.5 px to each side, and three more
  return {
      {"sum_points", 2 * kPoints, reads, [=] { points->sum(); }},
      {"sum_edges", 2 * kPoints, reads, [=] { points->sum_field(); }},
      {"find_edges", 2 * kSamples * kPoints, reads, [=] { points->edges(EdgeReading::plain); }},
      {"find_edges_smooth", 6 * kSamples * kPoints, reads, [=] { points->edges(EdgeReading::smooth); }},
      {"sum_weighted", 33 * kPoints, steps, [=] { points->sum_weights(); }},
      {"orientation_field", 33.0 * kFieldPartWidth * kFieldPartHeight, steps, [=] { points->field(); }},
      {"mean_lists", paper->additions() / 2, steps, [=] { paper->means(); }},
      {"dots", paper->products(), products, [=] { paper->radial(); }},
  };
}

const bool kRegistered = [] {
  for (const auto& [width, height] : {std::pair{96, 6}, {25, 20}, {60, 45}, {120, 90}}) {
    const auto load = std::make_shared<CoarseLoad>(width, height);
    const std::string name = "best_of_four/" + load->size() + "/";
    for (const NamedKernel& k : dot_product_kernels())
      if (k.able) add(name + k.name, load->items(), bench::dot_product_peak(k.name), 0, [=] { load->run(k.run); });
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets())
      add(name + hwy::TargetName(target), load->items(), bench::peak_of(target).products, target,
          [=] { load->run(highway_kernel()); });
  }
  for (const Work& work : highway_work())
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets())
      add(work.name + "/" + hwy::TargetName(target), work.items, work.peak(bench::peak_of(target)), target, work.call);
  return true;
}();

}  // namespace
}  // namespace pickcell::matches
