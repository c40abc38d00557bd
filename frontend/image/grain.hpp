#pragma once

#include <optional>

#include "frontend/messages.hpp"

namespace motorcade {

/// Standard deviation [gray] of white noise that explains how rough the 7x7 neighborhood of a pixel is (the mask of
/// Immerkaer, Fast Noise Variance Estimation, 1996). Straight edges do not change it. The pixel is 4 px or more from
/// the border.
float grainAround(const Image& image, int x, int y);

/// Grain of an image's smooth parts: the first quartile over a grid of neighborhoods that are not clipped to black or
/// white. Sensors give 1 to 3; much more is noise, and much less is a blurred or strongly compressed image. Empty where
/// most of the image is clipped, or it is too small.
std::optional<float> grainOf(const Image& image);

/// Returns the image with less noise, so that patches are recognized. The mean under a binomial 5x5 window replaces
/// each pixel by a share that grows with the grain from none to all. This costs sharpness, so images with the usual
/// grain stay as they are.
Image denoised(const Image& image, float grain_gray, ImagePool& pool);

}  // namespace motorcade
