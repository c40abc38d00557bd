#pragma once

#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "core/image.hpp"
#include "io/image_file.hpp"

namespace motorcade {

struct Color {
  int red = 0, green = 0, blue = 0;
};

/// A color image to draw on, anti-aliased. Coordinates are pixels, whole numbers at pixel centers; drawings are
/// clipped.
class Canvas {
 public:
  Canvas(int width, int height, Color background);
  /// A gray image as background.
  explicit Canvas(const Image& image);

  int width() const { return image_.width; }
  int height() const { return image_.height; }

  /// Of a pixel, which must lie on the canvas.
  void blend(int x, int y, Color color, double opacity);
  void line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, Color color, double width, double opacity = 1);
  void polyline(const std::vector<Eigen::Vector2d>& points, Color color, double width, double opacity = 1);
  /// Every second piece of `dash` pixels along the way.
  void dashedPolyline(const std::vector<Eigen::Vector2d>& points, Color color, double width, double dash,
                      double opacity = 1);
  void arrow(const Eigen::Vector2d& from, const Eigen::Vector2d& to, Color color, double width);
  /// Convex, corners in either order.
  void fillPolygon(const std::vector<Eigen::Vector2d>& corners, Color color, double opacity = 1);
  void outline(const std::vector<Eigen::Vector2d>& corners, Color color, double width, double opacity = 1);
  /// Printable ASCII; `at` is the upper left corner, `scale` the size of a font pixel.
  void text(const Eigen::Vector2d& at, std::string_view text, Color color, int scale = 2);
  static int textWidth(std::string_view text, int scale = 2);
  static int textHeight(int scale = 2);

  /// Puts another canvas onto this one.
  void paste(const Canvas& other, int x, int y);
  const RgbImage& image() const { return image_; }

 private:
  RgbImage image_;
};

}  // namespace motorcade
