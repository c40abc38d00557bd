#pragma once

#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "apps/canvas/color.hpp"
#include "apps/canvas/rectangle.hpp"
#include "core/image.hpp"
#include "io/images/image_file.hpp"

namespace motorcade {

/// Style of a line.
struct Pen {
  Color color{};
  double width_px = 1;
  double opacity = 1;
  std::vector<double> dashes_px{};  // on, off, ...; solid when empty
};

/// Style of an area.
struct Fill {
  Color color{};
  double opacity = 1;
};

struct TextStyle {
  Color color{};
  double size_px = 12;
  bool bold = false;
};

/// A color image to draw on, anti-aliased, with Cairo. Coordinates are pixels, whole numbers at pixel centers. Drawings
/// are clipped. Points that are not finite, or a million pixels away, are left out.
class Canvas {
 public:
  using Points = std::span<const Eigen::Vector2d>;

  Canvas(int width, int height, Color background);
  /// A gray image as background.
  explicit Canvas(const Image& image);
  ~Canvas();
  Canvas(Canvas&& other) noexcept;
  Canvas& operator=(Canvas&& other) noexcept;

  int width() const { return width_; }
  int height() const { return height_; }

  /// A part of this canvas as one of its own, with its upper left corner as origin. Drawings on it appear here, clipped
  /// to the part. This canvas must live longer.
  Canvas part(int left, int top, int width, int height);

  void line(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Pen& pen);
  void polyline(Points points, const Pen& pen);
  void outline(Points corners, const Pen& pen);
  void fill(Points corners, const Fill& fill);
  /// A line with a filled head at its end.
  void arrow(const Eigen::Vector2d& from, const Eigen::Vector2d& to, const Pen& pen);
  void dot(const Eigen::Vector2d& at, double radius_px, const Fill& fill);
  void fillRounded(const Rectangle& rectangle, double radius_px, const Fill& fill);
  /// Draws text in DejaVu Sans; `at` is the left end of the base line. Bytes that are not UTF-8 become question marks.
  void text(const Eigen::Vector2d& at, std::string_view text, const TextStyle& style);
  static double textWidth(std::string_view text, const TextStyle& style);
  /// A gray image, scaled to the rectangle.
  void paste(const Image& image, const Rectangle& to);

  RgbImage image() const;

 private:
  struct Surface;
  Canvas(std::unique_ptr<Surface> surface, int width, int height);
  std::unique_ptr<Surface> surface_;
  int width_, height_;
};

/// Corners of an ellipse about a center; `axes` takes the unit circle to it.
std::vector<Eigen::Vector2d> ellipse(const Eigen::Vector2d& center, const Eigen::Matrix2d& axes);

}  // namespace motorcade
