#include "apps/draw/canvas.hpp"

#include <algorithm>
#include <cmath>

#include "apps/draw/font.hpp"

namespace motorcade {
namespace {

using Eigen::Vector2d;

/// Whole pixels that a shape may touch, cut to the canvas.
struct PixelArea {
  int left, top, right, bottom;

  PixelArea(const Vector2d& least, const Vector2d& most, double margin, int width, int height)
      : left(clamped(least.x() - margin, width)),
        top(clamped(least.y() - margin, height)),
        right(clamped(most.x() + margin + 1, width)),
        bottom(clamped(most.y() + margin + 1, height)) {}
  static int clamped(double value, int limit) {
    return static_cast<int>(std::clamp(std::floor(value), 0.0, static_cast<double>(limit)));
  }
};

double distanceToSegment(const Vector2d& p, const Vector2d& from, const Vector2d& to) {
  const Vector2d way = to - from;
  const double length2 = way.squaredNorm();
  const double part = length2 > 0 ? std::clamp((p - from).dot(way) / length2, 0.0, 1.0) : 0;
  return (p - from - part * way).norm();
}

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

}  // namespace

Canvas::Canvas(int width, int height, Color background) {
  image_.width = width;
  image_.height = height;
  image_.pixels.resize(std::size_t{3} * width * height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) blend(x, y, background, 1);
}

Canvas::Canvas(const Image& image) : Canvas(image.width(), image.height(), {}) {
  for (int y = 0; y < height(); ++y)
    for (int x = 0; x < width(); ++x) std::fill_n(image_.at(x, y), 3, image.at(x, y));
}

void Canvas::blend(int x, int y, Color color, double opacity) {
  std::uint8_t* pixel = image_.at(x, y);
  const auto mix = [&](std::uint8_t& old, int value) {
    old = static_cast<std::uint8_t>(std::lround(old + opacity * (value - old)));
  };
  mix(pixel[0], color.red);
  mix(pixel[1], color.green);
  mix(pixel[2], color.blue);
}

void Canvas::line(const Vector2d& from, const Vector2d& to, Color color, double width, double opacity) {
  if (!from.allFinite() || !to.allFinite()) return;
  const PixelArea area(from.cwiseMin(to), from.cwiseMax(to), width / 2 + 1, this->width(), height());
  for (int y = area.top; y < area.bottom; ++y) {
    for (int x = area.left; x < area.right; ++x) {
      const double cover = std::clamp(width / 2 + 0.5 - distanceToSegment(Vector2d(x, y), from, to), 0.0, 1.0);
      if (cover > 0) blend(x, y, color, cover * opacity);
    }
  }
}

void Canvas::polyline(const std::vector<Vector2d>& points, Color color, double width, double opacity) {
  for (std::size_t i = 1; i < points.size(); ++i) line(points[i - 1], points[i], color, width, opacity);
}

void Canvas::dashedPolyline(const std::vector<Vector2d>& points, Color color, double width, double dash,
                            double opacity) {
  double done = 0;
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double length = (points[i] - points[i - 1]).norm();
    const Vector2d direction = (points[i] - points[i - 1]) / std::max(length, 1e-9);
    for (double at = 0; at < length;) {
      const double phase = std::fmod(done + at, 2 * dash);
      const double end = std::min(length, at + (phase < dash ? dash - phase : 2 * dash - phase) + 1e-6);
      if (phase < dash) line(points[i - 1] + at * direction, points[i - 1] + end * direction, color, width, opacity);
      at = end;
    }
    done += length;
  }
}

void Canvas::arrow(const Vector2d& from, const Vector2d& to, Color color, double width) {
  const double length = (to - from).norm();
  if (!(length > 1)) return;
  const Vector2d ahead = (to - from) / length, aside(-ahead.y(), ahead.x());
  const double head = std::min(length, 4 * width);
  line(from, to - 0.7 * head * ahead, color, width);
  fillPolygon({to, to - head * ahead + 0.5 * head * aside, to - head * ahead - 0.5 * head * aside}, color);
}

void Canvas::fillPolygon(const std::vector<Vector2d>& corners, Color color, double opacity) {
  Vector2d least = corners.front(), most = corners.front();
  double twice_area = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (!corners[i].allFinite()) return;
    least = least.cwiseMin(corners[i]);
    most = most.cwiseMax(corners[i]);
    twice_area += cross(corners[i], corners[(i + 1) % corners.size()]);
  }
  const double side = twice_area < 0 ? -1 : 1;
  const PixelArea area(least, most, 1, width(), height());
  for (int y = area.top; y < area.bottom; ++y) {
    for (int x = area.left; x < area.right; ++x) {
      double cover = 1;
      for (std::size_t i = 0; i < corners.size() && cover > 0; ++i) {
        const Vector2d edge = corners[(i + 1) % corners.size()] - corners[i];
        const double inside = side * cross(edge, Vector2d(x, y) - corners[i]) / std::max(edge.norm(), 1e-9);
        cover = std::min(cover, inside + 0.5);
      }
      if (cover > 0) blend(x, y, color, cover * opacity);
    }
  }
}

void Canvas::outline(const std::vector<Vector2d>& corners, Color color, double width, double opacity) {
  for (std::size_t i = 0; i < corners.size(); ++i)
    line(corners[i], corners[(i + 1) % corners.size()], color, width, opacity);
}

void Canvas::text(const Vector2d& at, std::string_view text, Color color, int scale) {
  if (!at.allFinite()) return;
  int left = static_cast<int>(std::lround(at.x()));
  const int top = static_cast<int>(std::lround(at.y()));
  for (const char letter : text) {
    for (int y = 0; y < kGlyphHeight * scale; ++y) {
      for (int x = 0; x < kGlyphWidth * scale; ++x) {
        const bool in_canvas = left + x >= 0 && left + x < width() && top + y >= 0 && top + y < height();
        if (in_canvas && glyphPixel(letter, x / scale, y / scale)) blend(left + x, top + y, color, 1);
      }
    }
    left += (kGlyphWidth + 1) * scale;
  }
}

int Canvas::textWidth(std::string_view text, int scale) {
  return (static_cast<int>(text.size()) * (kGlyphWidth + 1) - 1) * scale;
}
int Canvas::textHeight(int scale) { return kGlyphHeight * scale; }

void Canvas::paste(const Canvas& other, int x, int y) {
  for (int row = std::max(0, -y); row < other.height() && y + row < height(); ++row) {
    for (int column = std::max(0, -x); column < other.width() && x + column < width(); ++column) {
      std::copy_n(other.image_.at(column, row), 3, image_.at(x + column, y + row));
    }
  }
}

}  // namespace motorcade
