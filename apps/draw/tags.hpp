#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/canvas/rectangle.hpp"
#include "apps/draw/marks.hpp"

namespace motorcade {

/// A label of a given size that belongs beside something.
struct LabelRequest {
  Rectangle anchor;
  double width = 0, height = 0;
};

/// Places one label after the other, each where it is nearest to its anchor and hides least of the anchors. No two
/// overlap, and all lie within the area. A label that finds no room is left out.
std::vector<std::optional<Rectangle>> placeLabels(std::span<const LabelRequest> requests, const Rectangle& area);

/// One or two lines of text about an object, placed beside its anchor.
struct Tag {
  Color color{};
  std::string name{}, facts{};  // without facts it has one line
  Rectangle anchor{};
};

/// Puts each tag on a dark plate with an edge of its color, linked by a line to its anchor if that is not near. The
/// first ones have the best places, and none overlap. Returns the plates that found room.
std::vector<Rectangle> paintTags(Sheet& sheet, const std::vector<Tag>& tags);

}  // namespace motorcade
