/// The coarse kernel per target: multiply-adds of bytes per second; 96x6 fills the registers from the first cache and
/// is the peak to compare with.

#include <benchmark/benchmark.h>

#include <random>
#include <string>
#include <vector>

#include <hwy/highway.h>

#include "pickcell/matches/coarse_kernel.hpp"

namespace pickcell::matches {
namespace {

struct Load {
  std::vector<std::uint32_t> cells;
  std::vector<std::int32_t> offsets;
  std::vector<std::int8_t> weights;
  FourTemplates templates{};
  int width, height, stride;

  Load(int w, int h, int taps) : width(w), height(h), stride(w + 64) {
    std::mt19937 rng(1);
    cells.resize(static_cast<std::size_t>(stride * (h + 40)));
    for (auto& c : cells) c = static_cast<std::uint32_t>(rng());
    for (int k = 0; k < taps; ++k) {
      offsets.push_back(k / 8 * stride + 2 * (k % 8));
      for (int i = 0; i < 16; ++i) weights.push_back(static_cast<std::int8_t>(rng() % 201) - 100);
    }
    templates = {offsets, weights, {0, 0, 0, 0}, {1, 1, 1, 1}};
  }
};

void run(benchmark::State& state, CoarseKernel kernel, int width, int height) {
  const Load load(width, height, 80);
  std::vector<float> score(static_cast<std::size_t>((width + kKernelBlock) * height));
  for (auto unused : state) {
    static_cast<void>(unused);
    kernel({load.cells.data(), load.stride, width, height}, load.templates, score.data(), width + kKernelBlock);
    benchmark::DoNotOptimize(score.data());
  }
  const double products = 16.0 * 80 * width * height;
  state.counters["MAC/s"] = benchmark::Counter(products, benchmark::Counter::kIsIterationInvariantRate);
}

void add(const std::string& name, CoarseKernel kernel, std::int64_t target) {
  for (const auto& [width, height] : {std::pair{96, 6}, {25, 20}, {60, 45}, {120, 90}})
    benchmark::RegisterBenchmark((name + "/" + std::to_string(width) + "x" + std::to_string(height)).c_str(),
                                 [kernel, target, w = width, h = height](benchmark::State& state) {
                                   hwy::SetSupportedTargetsForTest(target);
                                   run(state, kernel, w, h);
                                   hwy::SetSupportedTargetsForTest(0);
                                 });
}

const bool kRegistered = [] {
  for (const NamedKernel& k : dot_product_kernels())
    if (k.able) add(k.name, k.run, 0);
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets())
    add(hwy::TargetName(target), highway_kernel(), target);
  return true;
}();

}  // namespace
}  // namespace pickcell::matches
