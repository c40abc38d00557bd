#pragma once

#include <optional>

#include "apps/draw/marks.hpp"
#include "apps/recorded/recorded_drive.hpp"
#include "io/images/image_file.hpp"

namespace motorcade {

/// What is drawn on: the left image and the mask of the objects, where there is one.
struct DrawnImages {
  Image left;
  std::optional<Gray16Image> mask{};
};

/// The left image with each object's mask, points and cuboid (its box, where no cuboid is known), its way of the last
/// seconds and an arrow of one second's motion on the ground, and a tag with its kind, distance and speed. Without a
/// legend: what needs one is for `drawFrame`.
RgbImage drawImageView(const DrawnImages& images, const RecordedDrive& drive, std::size_t frame);

/// The same onto a sheet that shows the left image already, pixel by pixel.
void paintImageView(Sheet& sheet, const DrawnImages& images, const RecordedDrive& drive, std::size_t frame);

}  // namespace motorcade
