#pragma once

#include <optional>

#include "frontend/messages.hpp"

namespace motorcade {

/// Standard deviation [gray] of white noise that explains how rough the 7x7 neighborhood of a pixel is (the mask of
/// Immerkaer, Fast Noise Variance Estimation, 1996). Straight edges do not change it. The pixel is 4 px or more from
/// the border.
float grainAround(const Image& image, int x, int y);

/// Grain of an image, over a grid of neighborhoods that are not clipped to black or white.
struct Grain {
  /// First quartile [gray]: that of the smooth parts. Sensors give 1 to 3; much more is noise, and much less is a
  /// blurred or strongly compressed image.
  float smooth_gray = 1;
  /// Median [gray], as white noise that is as large a share of the contrast of daylight. Contrast is the range of the
  /// middle half of the gray levels. At night both are small, and noise grows with the light: smooth parts are the dark
  /// ones, and tell little of it.
  float relative_gray = 1;

  /// The larger of each.
  Grain with(const Grain& other) const;
};
/// Empty where most of the image is clipped, or it is too small.
std::optional<Grain> grainOf(const Image& image);

/// Returns the image with less noise, so that patches are recognized. The mean under a binomial 5x5 window replaces
/// each pixel by a share that grows with the grain from none to all. This costs sharpness, so images with the usual
/// grain stay as they are. Relative grain has half the weight: a dark image has hardly any corners of noise, as their
/// score is absolute, but its patches are lost.
Image denoised(const Image& image, const Grain& grain, ImagePool& pool);

}  // namespace motorcade
