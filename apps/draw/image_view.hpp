#pragma once

#include "apps/draw/palette.hpp"
#include "apps/recorded/recorded_drive.hpp"

namespace motorcade {

/// The left image with each object's mask, points and cuboid (its box, where no cuboid is known), its way of the last
/// seconds and an arrow of one second's motion on the ground, and a tag with its kind, distance and speed.
Canvas drawImageView(const DrawnImages& images, const RecordedDrive& run, std::size_t frame);

}  // namespace motorcade
