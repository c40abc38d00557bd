#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "core/image.hpp"

/// Images as a color sensor gives them: a filter of one color on each pixel, in squares of two by two.
namespace motorcade {

/// The filters of the first two pixels of the first two rows, row by row.
enum class BayerPattern { kRggb, kBggr, kGrbg, kGbrg };

std::string_view nameOf(BayerPattern pattern);
/// Empty for no such name; case does not matter, and ROS' `bayer_rggb8` is understood.
std::optional<BayerPattern> bayerPatternOf(std::string_view name);

/// The gray of a mosaic at its full size: the luma, weighed as by `grayOf`. Each color is the mean of its nearest
/// pixels. See the source for the formula.
Image grayOfMosaic(const Image& mosaic, BayerPattern pattern, ImagePool& pool);

/// Names the Bayer patterns with the same two green pixels if a gray image is in fact a mosaic. Empty for other images
/// and where this is uncertain, as in a scene without colors.
std::optional<std::string> suspectedMosaic(const Image& image);

}  // namespace motorcade
