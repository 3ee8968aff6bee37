#pragma once
/// The discrete Fourier transform of a closed curve's samples.

#include <complex>
#include <memory>

namespace pickcell::matches {

/// Of `size` values, in place; the inverse is not divided by their number. One thread at a time.
class Fourier {
 public:
  explicit Fourier(int size);
  ~Fourier();
  void forward(std::complex<float>* values) const;
  void inverse(std::complex<float>* values) const;

 private:
  struct Plan;
  std::unique_ptr<Plan> plan_;
};

}  // namespace pickcell::matches
