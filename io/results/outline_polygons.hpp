#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/messages.hpp"

namespace motorcade {

/// Corners [px], in order.
using Polygon = std::vector<Eigen::Vector2i>;

/// The outer borders of a mask's pieces, the largest first, as pixels of the left image that still show the object; the
/// stairs of its cells are smoothed. Pieces of less than three corners are left out.
std::vector<Polygon> outlinePolygons(const ObjectMask& mask, int width_px, int height_px);

/// A line of `outlines.jsonl` (docs/formats.md).
std::string outlineLine(FrameId frame, TrackId track, const std::vector<Polygon>& polygons);

}  // namespace motorcade
