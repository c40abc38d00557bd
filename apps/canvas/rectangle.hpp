#pragma once

#include <algorithm>

#include <Eigen/Core>

namespace motorcade {

/// An upright rectangle in pixels of a canvas.
struct Rectangle {
  double left = 0, top = 0, width = 0, height = 0;

  double right() const { return left + width; }
  double bottom() const { return top + height; }
  Eigen::Vector2d middle() const { return {left + 0.5 * width, top + 0.5 * height}; }
  Rectangle grownBy(double margin) const {
    return {left - margin, top - margin, width + 2 * margin, height + 2 * margin};
  }
  bool contains(const Rectangle& other) const {
    return other.left >= left && other.right() <= right() && other.top >= top && other.bottom() <= bottom();
  }
  bool contains(const Eigen::Vector2d& at) const { return contains(Rectangle{at.x(), at.y(), 0, 0}); }
  /// The area that both cover; 0 where they do not meet.
  double overlap(const Rectangle& other) const {
    const double across = std::min(right(), other.right()) - std::max(left, other.left);
    const double down = std::min(bottom(), other.bottom()) - std::max(top, other.top);
    return across > 0 && down > 0 ? across * down : 0;
  }
};

}  // namespace motorcade
