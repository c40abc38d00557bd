#pragma once

#include <optional>

#include "apps/draw/marks.hpp"
#include "apps/recorded/recorded_drive.hpp"
#include "io/images/image_file.hpp"

namespace motorcade {

/// Images to draw on: the left one and the mask of the objects, where there is one.
struct DrawnImages {
  Image left;
  std::optional<Gray16Image> mask{};
};

/// The left image with each object's mask, points, cuboid and tag. Where no cuboid is known, the box is drawn. Its path
/// of the last seconds and an arrow of one second's motion lie on the ground. The tag tells kind, distance and speed.
/// It has no legend, which `drawFrame` adds.
RgbImage drawImageView(const DrawnImages& images, const RecordedDrive& drive, std::size_t frame);

/// Draws the same onto a sheet that already shows the left image, pixel by pixel.
void paintImageView(Sheet& sheet, const DrawnImages& images, const RecordedDrive& drive, std::size_t frame);

}  // namespace motorcade
