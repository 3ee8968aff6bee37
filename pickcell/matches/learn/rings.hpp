#pragma once
/// A part in rings about a centre, and the mean of it and its turns: whatever the period, both sides of every
/// comparison have been resampled alike, once.

#include <complex>
#include <vector>

#include "pickcell/matches/learn/fourier.hpp"
#include "pickcell/matches/learn/part_picture.hpp"

namespace pickcell::matches {

/// Samples on circles half a pixel, one and a half, ... from the centre, at most a pixel apart. Real part: grey,
/// imaginary part: cover.
class Rings {
 public:
  using Sample = std::complex<float>;

  Rings(const PartPicture& part, double centre_x, double centre_y, double radius);
  [[nodiscard]] int rings() const { return rings_; }
  [[nodiscard]] int angles() const { return angles_; }
  [[nodiscard]] double radius(int ring) const { return ring + 0.5; }
  [[nodiscard]] const Sample* ring(int i) const { return samples_.data() + offset(i); }
  /// Clockwise on the screen, from x to y.
  [[nodiscard]] Sample direction(int angle) const { return directions_[static_cast<std::size_t>(angle)]; }
  [[nodiscard]] std::size_t offset(int ring) const {
    return static_cast<std::size_t>(ring) * static_cast<std::size_t>(angles_);
  }

  /// The mean of the part and all its turns by 360/period degrees; period 0: by any angle. Laid out as the samples.
  void mean_of_turns(int period, std::vector<Sample>& out) const;

 private:
  int rings_, angles_;
  Fourier fourier_;
  std::vector<Sample> directions_, samples_, spectrum_;
};

}  // namespace pickcell::matches
