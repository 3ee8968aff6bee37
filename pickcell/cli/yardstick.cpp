#include "pickcell/cli/yardstick.hpp"

#include <malloc.h>

#include "pickcell/matches/work.hpp"

#ifdef PICKCELL_WITH_YARDSTICK
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#endif

namespace pickcell::cli {

void keep_freed_memory() {
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, -1);  // 4 GiB does not fit mallopt's int; -1: never
  mallopt(M_TOP_PAD, 256 << 20);
}

#ifdef PICKCELL_WITH_YARDSTICK

struct Yardstick::Pictures {
  cv::Mat scene = cv::Mat(480, 640, CV_8U);
  cv::Mat part;

  Pictures() {
    cv::setNumThreads(1);
    cv::RNG random(20240);
    random.fill(scene, cv::RNG::UNIFORM, 0, 256);
    part = scene(cv::Rect(200, 150, 128, 128)).clone();
  }
};

Yardstick::Yardstick() : pictures_(std::make_unique<Pictures>()) { (void)measure_ms(); }

bool Yardstick::available() { return true; }

std::optional<double> Yardstick::measure_ms() {
  const double start_ms = matches::thread_cpu_ms();
  cv::Mat score;
  cv::matchTemplate(pictures_->scene, pictures_->part, score, cv::TM_CCOEFF_NORMED);
  return matches::thread_cpu_ms() - start_ms;
}

#else

struct Yardstick::Pictures {};
Yardstick::Yardstick() = default;
bool Yardstick::available() { return false; }
std::optional<double> Yardstick::measure_ms() { return std::nullopt; }

#endif

Yardstick::~Yardstick() = default;

}  // namespace pickcell::cli
