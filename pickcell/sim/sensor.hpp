#pragma once
/// From light on the sensor to grey values: blur, vignette, gain, noise, quantisation.

#include <cstdint>

#include "pickcell/image/image.hpp"

namespace pickcell::sim {

/// Light, where 1 is full scale.
using LightPlane = image::Plane<float>;

struct SensorSettings {
  double gain = 1;             ///< of contrast and brightness together
  double offset_grey = 0;      ///< added, grey values
  double gradient = 0;         ///< brightness changes by +- this fraction from one side to the other
  double gradient_deg = 0;     ///< towards the brighter side, counter-clockwise on the screen
  double vignette = 0;         ///< fraction lost in the corners
  double noise_grey = 1;       ///< standard deviation where the picture is dark
  double shot_noise_grey = 0;  ///< further standard deviation at full scale, growing with the root of the light
};

/// Gaussian blur, separable, edges repeated. sigma_px = 0 leaves the plane as it is.
void blur(LightPlane& light, double sigma_px);

/// Average along a straight way of the given length and direction (counter-clockwise on the screen).
void motion_blur(LightPlane& light, double length_px, double direction_deg);

/// Deterministic for a seed.
[[nodiscard]] image::Image expose(const LightPlane& light, const SensorSettings& settings, std::uint64_t seed);

}  // namespace pickcell::sim
