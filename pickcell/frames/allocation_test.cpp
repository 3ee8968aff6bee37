/// A running camera allocates nothing per frame, whatever its pixel format.

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <deque>
#include <vector>

#include "pickcell/frames/live_source.hpp"
#include "pickcell/frames/pixel_format.hpp"
#include "pickcell/image/codec.hpp"

namespace {
std::atomic<long> g_allocations{0};
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kCounts = false;  // the sanitizer has its own
#else
constexpr bool kCounts = true;
// Of the whole program, of its threads and of the C libraries below it: glibc lets a program put its own in front.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void* malloc(std::size_t n) {
  ++g_allocations;
  return __libc_malloc(n);
}
void* calloc(std::size_t n, std::size_t size) {
  ++g_allocations;
  return __libc_calloc(n, size);
}
void* realloc(void* p, std::size_t n) {
  ++g_allocations;
  return __libc_realloc(p, n);
}
void* aligned_alloc(std::size_t align, std::size_t n) {
  ++g_allocations;
  return __libc_memalign(align, n);
}
}
#endif

namespace pickcell::frames {
namespace {

using std::chrono::milliseconds;

constexpr int kW = 160, kH = 120;

/// Answers each trigger with the same bytes.
class AnsweringDevice final : public CameraDevice {
 public:
  AnsweringDevice(const std::vector<std::byte>& bytes, const std::string& format) : bytes_(bytes) {
    info_.id = "a camera whose name is far too long for a small string";
    info_.width_px = kW;
    info_.height_px = kH;
    info_.settings.pixel_format = format;
    code_ = format == "JPEG" ? kJpeg : pixel_format(format)->code;
  }
  [[nodiscard]] const DeviceInfo& info() const override { return info_; }
  [[nodiscard]] core::Result<std::optional<Arrival>> next(milliseconds timeout) override {
    std::unique_lock lock(mutex_);
    if (!asked_.wait_for(lock, timeout, [&] { return due_ > 0; })) return std::optional<Arrival>();
    --due_;
    Arrival a;
    a.id = ++id_;
    a.began = std::chrono::steady_clock::now();
    a.device_ns = a.began.time_since_epoch().count();
    a.picture = {bytes_, code_, kW, kH, 0};
    return std::optional<Arrival>(a);
  }
  [[nodiscard]] core::Status trigger() override {
    const std::lock_guard lock(mutex_);
    ++due_;
    asked_.notify_all();
    return {};
  }
  [[nodiscard]] core::Status check() override { return {}; }

 private:
  const std::vector<std::byte>& bytes_;
  DeviceInfo info_;
  std::uint32_t code_ = 0;
  std::mutex mutex_;
  std::condition_variable asked_;
  int due_ = 0;
  std::uint64_t id_ = 0;
};

std::vector<std::byte> jpeg_bytes() {
  image::Image picture(kW, kH);
  for (int y = 0; y < kH; ++y)
    for (int x = 0; x < kW; ++x) picture.at(x, y) = static_cast<std::uint8_t>((x * 7 + y * 13) % 256);
  return image::encode_jpeg(picture.view(), 90);
}

class AllocationsOf : public ::testing::TestWithParam<const char*> {};

TEST_P(AllocationsOf, AreNonePerFrame) {
  if (!kCounts) GTEST_SKIP() << "allocations belong to the sanitizer";
  const std::string format = GetParam();
  const std::vector<std::byte> bytes =
      format == "JPEG" ? jpeg_bytes() : std::vector<std::byte>(std::size_t{kW} * kH * 4, std::byte{77});
  core::RealClock clock;
  const auto seat = clock.join("test");
  LiveSource::Options options;
  options.software_trigger = true;
  auto source = LiveSource::open(
      [&]() -> core::Result<std::unique_ptr<CameraDevice>> {
        return std::unique_ptr<CameraDevice>(std::make_unique<AnsweringDevice>(bytes, format));
      },
      options, clock);
  ASSERT_TRUE(source);
  long before = 0;
  constexpr int kWarmUp = 20, kFrames = 200;
  for (int i = 0; i < kWarmUp + kFrames; ++i) {
    if (i == kWarmUp) before = g_allocations;
    const auto frame = (*source)->grab(*seat, std::chrono::seconds(20));
    if (!frame || frame->picture->width() != kW) FAIL() << format;
  }
  const long during = g_allocations - before;
  EXPECT_GT(before, 0) << "allocations are not counted at all";
  EXPECT_EQ(during, 0) << format;
}

TEST(Allocations, AreNoneWhereClocksAreMapped) {
  if (!kCounts) GTEST_SKIP() << "allocations belong to the sanitizer";
  ClockMap map;
  const long before = g_allocations;
  for (std::int64_t t_ns = 1; t_ns < 60'000'000'000; t_ns += 40'000'000)
    map.observe(t_ns, core::TimePoint(core::Duration(t_ns + t_ns / 20'000 + t_ns % 7'000'000)));
  EXPECT_EQ(g_allocations - before, 0);
  EXPECT_TRUE(map.known());
}

INSTANTIATE_TEST_SUITE_P(Formats, AllocationsOf,
                         ::testing::Values("Mono8", "Mono12", "Mono12p", "Mono10Packed", "BayerRG8", "BayerRG12",
                                           "RGB8", "YUV422_8", "JPEG"));

}  // namespace
}  // namespace pickcell::frames
