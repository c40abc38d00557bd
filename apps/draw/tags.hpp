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

/// Puts each on a dark plate with an edge of its color, with a thread to what it belongs to where that is not near;
/// the first ones have the best places, and none overlap. Gives the plates that found room.
std::vector<Rectangle> paintTags(Sheet& sheet, const std::vector<Tag>& tags);

}  // namespace motorcade
