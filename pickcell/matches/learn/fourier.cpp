#include "pickcell/matches/learn/fourier.hpp"

#include <algorithm>
#include <unsupported/Eigen/FFT>
#include <vector>

namespace pickcell::matches {

struct Fourier::Plan {
  Eigen::FFT<float> fft;
  std::vector<std::complex<float>> before;  ///< the library writes elsewhere than it reads
};

Fourier::Fourier(int size) : plan_(std::make_unique<Plan>()) {
  plan_->fft.SetFlag(Eigen::FFT<float>::Unscaled);
  plan_->before.resize(static_cast<std::size_t>(size));
}

Fourier::~Fourier() = default;

void Fourier::forward(std::complex<float>* values) const {
  std::copy_n(values, plan_->before.size(), plan_->before.begin());
  plan_->fft.fwd(values, plan_->before.data(), static_cast<Eigen::Index>(plan_->before.size()));
}

void Fourier::inverse(std::complex<float>* values) const {
  std::copy_n(values, plan_->before.size(), plan_->before.begin());
  plan_->fft.inv(values, plan_->before.data(), static_cast<Eigen::Index>(plan_->before.size()));
}

}  // namespace pickcell::matches
