#pragma once

#include <array>
#include <cstdio>
#include <optional>
#include <string>

#include "apps/draw/canvas.hpp"
#include "core/ids.hpp"
#include "io/image_file.hpp"

namespace motorcade {

/// What is drawn on: the left image and the mask of the objects, where there is one.
struct DrawnImages {
  Image left;
  std::optional<Gray16Image> mask{};
};

/// Each track its color, the same in every picture.
Color trackColor(TrackId track);

/// Halfway to white: for points on what has the color itself.
Color lightened(Color color);

/// As printf.
template <class... Values>
std::string format(const char* pattern, Values... values) {
  std::array<char, 128> text;
  std::snprintf(text.data(), text.size(), pattern, values...);
  return text.data();
}

}  // namespace motorcade
