#pragma once

#include <string>
#include <vector>

#include "apps/draw/marks.hpp"

namespace motorcade {

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
