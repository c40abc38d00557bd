#include "apps/draw/mask_view.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "apps/draw/palette.hpp"
#include "io/images/mask_image.hpp"
#include "io/results/outline_polygons.hpp"

namespace motorcade {
namespace {

/// Bounding box of the pixels of one value.
struct Bounds {
  int left, top, right, bottom;
};

std::map<std::uint16_t, Bounds> boundsByValue(const Gray16Image& mask) {
  std::map<std::uint16_t, Bounds> all;
  const std::uint16_t* pixel = mask.pixels.data();
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x, ++pixel) {
      if (*pixel == 0) continue;
      Bounds& bounds = all.try_emplace(*pixel, Bounds{x, y, x, y}).first->second;
      bounds.left = std::min(bounds.left, x);
      bounds.right = std::max(bounds.right, x);
      bounds.bottom = y;
    }
  }
  return all;
}

/// True when each square of pixels is all of the value or none of it. Masks are then made of such cells, or larger
/// ones.
bool isMadeOf(int cell_px, const Gray16Image& mask, std::uint16_t value, const Bounds& bounds) {
  const auto isSet = [&](int x, int y) {
    return mask.pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(mask.width) +
                       static_cast<std::size_t>(x)] == value;
  };
  for (int y = bounds.top; y <= bounds.bottom; ++y)
    for (int x = bounds.left; x <= bounds.right; ++x)
      if (isSet(x, y) != isSet(x - (x - bounds.left) % cell_px, y - (y - bounds.top) % cell_px)) return false;
  return true;
}

ObjectMask cut(const Gray16Image& mask, std::uint16_t value, const Bounds& bounds) {
  int cell_px = 8;
  while (cell_px > 1 && !isMadeOf(cell_px, mask, value, bounds)) cell_px /= 2;
  ObjectMask object{.track = trackOfMask(value),
                    .left_px = bounds.left,
                    .top_px = bounds.top,
                    .cell_px = cell_px,
                    .width = (bounds.right - bounds.left) / cell_px + 1,
                    .height = (bounds.bottom - bounds.top) / cell_px + 1,
                    .inside = {}};
  for (int row = 0; row < object.height; ++row)
    for (int column = 0; column < object.width; ++column) {
      const auto at = static_cast<std::size_t>(bounds.top + row * cell_px) * static_cast<std::size_t>(mask.width) +
                      static_cast<std::size_t>(bounds.left + column * cell_px);
      object.inside.push_back(mask.pixels[at] == value ? 1 : 0);
    }
  return object;
}

/// Cuts the corners of a closed outline twice, each side's by a quarter (Chaikin 1974) or, where it is long, by a cell.
std::vector<Eigen::Vector2d> rounded(const Polygon& polygon, int cell_px) {
  std::vector<Eigen::Vector2d> corners;
  for (const Eigen::Vector2i& corner : polygon) corners.emplace_back(corner.cast<double>());
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<Eigen::Vector2d> cut_corners;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Eigen::Vector2d& from = corners[i];
      const Eigen::Vector2d side = corners[(i + 1) % corners.size()] - from;
      const double share = std::min(0.25, cell_px / std::max(1.0, side.norm()));
      cut_corners.emplace_back(from + share * side);
      cut_corners.emplace_back(from + (1 - share) * side);
    }
    corners = std::move(cut_corners);
  }
  return corners;
}

}  // namespace

void paintMask(Sheet& sheet, const Gray16Image& mask) {
  constexpr double kInside = 0.3, kRim = 0.95;
  for (const auto& [value, bounds] : boundsByValue(mask)) {
    const Color color = trackColor(trackOfMask(value));
    const ObjectMask object = cut(mask, value, bounds);
    for (const Polygon& polygon : outlinePolygons(object, mask.width, mask.height)) {
      const auto corners = rounded(polygon, object.cell_px);
      sheet.note(Mark::kMask, corners);
      sheet.canvas.fill(corners, {color, kInside});
      sheet.canvas.outline(corners, {.color = color, .width_px = 1.2, .opacity = kRim});
    }
  }
}

}  // namespace motorcade
