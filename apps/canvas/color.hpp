#pragma once

namespace motorcade {

/// RGB color, 0 to 255 each.
struct Color {
  int red = 0, green = 0, blue = 0;
};

/// `share` of the way from one color to another.
inline Color between(Color from, Color to, double share) {
  const auto mixed = [share](int a, int b) { return static_cast<int>(a + share * (b - a)); };
  return {mixed(from.red, to.red), mixed(from.green, to.green), mixed(from.blue, to.blue)};
}

/// Halfway to white, for points on a surface of that color.
inline Color lightened(Color color) { return between(color, {255, 255, 255}, 0.5); }

}  // namespace motorcade
