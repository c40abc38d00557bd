#include "frontend/shape/outline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "frontend/shape/cuboid_volumes.hpp"
#include "frontend/shape/motion_evidence.hpp"

namespace motorcade {
namespace {

constexpr float kConnected_px = 1.0F;             // of the level: between neighbors on one surface
constexpr int kFringeLeft = 2, kFringeRight = 1;  // cells
constexpr double kLeastUsual = 0.7;               // of a piece's cells, so that it is one of the object's
constexpr std::uint8_t kOutside = CuboidVolumes::kOutside, kPossible = CuboidVolumes::kPossible,
                       kUsual = CuboidVolumes::kUsual;

/// A cell is what most of its 3x3 neighbors and itself are.
void smooth(Outline& outline) {
  const int width = outline.window.width, height = outline.window.height;
  std::vector<std::uint8_t> across(outline.inside.size());  // how many of three in a row
  for (int row = 0; row < height; ++row) {
    const std::uint8_t* inside = outline.inside.data() + static_cast<std::size_t>(row) * width;
    std::uint8_t* sums = across.data() + static_cast<std::size_t>(row) * width;
    for (int column = 0; column < width; ++column) sums[column] = inside[column] != kOutside;
    for (int column = 1; column < width; ++column) sums[column] += inside[column - 1] != kOutside;
    for (int column = 0; column + 1 < width; ++column) sums[column] += inside[column + 1] != kOutside;
  }
  for (int row = 0; row < height; ++row) {
    const int first = std::max(row - 1, 0), last = std::min(row + 1, height - 1);
    for (int column = 0; column < width; ++column) {
      int sum = 0;
      for (int y = first; y <= last; ++y) sum += across[static_cast<std::size_t>(y) * width + column];
      const int cells = (last - first + 1) * (1 + (column > 0 ? 1 : 0) + (column + 1 < width ? 1 : 0));
      std::uint8_t& cell = outline.inside[static_cast<std::size_t>(row) * width + column];
      cell = 2 * sum <= cells ? kOutside : cell == kOutside ? kPossible : cell;
    }
  }
}

/// Keeps the connected piece that has most in the usual volume, and those that lie there for the most part.
void dropPieces(Outline& outline, const DisparityMap& map) {
  const int width = outline.window.width, height = outline.window.height;
  std::vector<int> piece(outline.inside.size(), -1), sizes, usual;
  std::vector<int> open;
  for (std::size_t seed = 0; seed < outline.inside.size(); ++seed) {
    if (!outline.inside[seed] || piece[seed] >= 0) continue;
    const int id = static_cast<int>(sizes.size());
    sizes.push_back(0), usual.push_back(0);
    open.assign(1, static_cast<int>(seed));
    piece[seed] = id;
    while (!open.empty()) {
      const int at = open.back(), column = at % width, row = at / width;
      open.pop_back();
      ++sizes[id];
      usual[id] += outline.inside[at] == kUsual;
      const auto reach = [&](int x, int y) {
        if (x < 0 || y < 0 || x >= width || y >= height) return;
        const int next = y * width + x;
        if (!outline.inside[next] || piece[next] >= 0) return;
        const float here_px = map.disparity_px[at], there_px = map.disparity_px[next];
        const bool known = here_px != DisparityMap::kNone && there_px != DisparityMap::kNone;
        if (known && std::abs(here_px - there_px) > kConnected_px) return;
        piece[next] = id;
        open.push_back(next);
      };
      reach(column - 1, row), reach(column + 1, row), reach(column, row - 1), reach(column, row + 1);
    }
  }
  if (sizes.empty()) return;
  const auto main = static_cast<int>(std::ranges::max_element(usual) - usual.begin());
  for (std::size_t i = 0; i < piece.size(); ++i) {
    const int id = piece[i];
    outline.inside[i] = id >= 0 && (id == main || usual[id] > kLeastUsual * sizes[id]) ? 1 : 0;
  }
}

/// Windows and smooth paint give no disparity, or a wrong one: what has cells of the object on all four sides is its.
void fillGaps(Outline& outline) {
  const auto rows = outline.spansOfRows(), columns = outline.spansOfColumns();
  for (int row = 0; row < outline.window.height; ++row)
    for (int column = rows[row].first; column <= rows[row].second; ++column)
      if (columns[column].first <= row && row <= columns[column].second)
        outline.inside[static_cast<std::size_t>(row) * outline.window.width + column] = 1;
}

/// The windows that are compared make objects wider than they are; at the left, so does what only the left image sees.
void takeOffFringe(Outline& outline) {
  const auto rows = outline.spansOfRows();
  for (int row = 0; row < outline.window.height; ++row) {
    const int first = rows[row].first, last = rows[row].second;
    const auto clear = [&](int from, int to) {
      for (int column = std::max(from, first); column <= std::min(to, last); ++column)
        outline.inside[static_cast<std::size_t>(row) * outline.window.width + column] = 0;
    };
    if (first > 0) clear(first, first + kFringeLeft - 1);
    if (last + 1 < outline.window.width) clear(last - kFringeRight + 1, last);
  }
}

}  // namespace

PixelWindow Outline::bounds() const {
  int left = window.width, right = -1, top = window.height, bottom = -1;
  for (int row = 0; row < window.height; ++row)
    for (int column = 0; column < window.width; ++column)
      if (at(column, row)) {
        left = std::min(left, column), right = std::max(right, column);
        top = std::min(top, row), bottom = std::max(bottom, row);
      }
  return {left, top, right - left + 1, bottom - top + 1};
}

Outline::Spans Outline::spansOfRows() const {
  Spans spans(window.height, {window.width, -1});
  for (int row = 0; row < window.height; ++row)
    for (int column = 0; column < window.width; ++column)
      if (at(column, row)) spans[row] = {std::min(spans[row].first, column), column};
  return spans;
}

Outline::Spans Outline::spansOfColumns() const {
  Spans spans(window.width, {window.height, -1});
  for (int row = 0; row < window.height; ++row)
    for (int column = 0; column < window.width; ++column)
      if (at(column, row)) spans[column] = {std::min(spans[column].first, row), row};
  return spans;
}

int Outline::count() const { return static_cast<int>(std::ranges::count(inside, 1)); }

std::vector<int> Outline::samples() const {
  constexpr double kMost = 400;
  const int step = std::max(1, static_cast<int>(std::sqrt(count() / kMost)));
  std::vector<int> cells;
  for (int row = step / 2; row < window.height; row += step)
    for (int column = step / 2; column < window.width; column += step)
      if (at(column, row)) cells.push_back(row * window.width + column);
  return cells;
}

std::vector<int> cellsInReach(const LevelDisparities& disparities, const ObjectView& view, const StereoCamera& camera) {
  std::vector<std::uint8_t> inside(disparities.map.disparity_px.size(), kPossible);
  CuboidVolumes(disparities, view, camera).tell(CuboidVolumes::coarseSigma_px(disparities.level), inside);
  std::vector<int> cells;
  cells.reserve(inside.size());
  for (std::size_t cell = 0; cell < inside.size(); ++cell)
    if (inside[cell] != kOutside) cells.push_back(static_cast<int>(cell));
  return cells;
}

Outline findOutline(const LevelDisparities& disparities, std::span<const int> cells, const ObjectView& view,
                    const StereoCamera& camera) {
  Outline outline{.window = disparities.map.window, .inside = {}};
  outline.inside.resize(static_cast<std::size_t>(outline.window.area()), kOutside);
  for (const int cell : cells) outline.inside[cell] = kPossible;
  CuboidVolumes(disparities, view, camera).tell(CuboidVolumes::kDisparitySigma_px, outline.inside);
  if (view.before) dropResting(outline, disparities, view, camera);
  smooth(outline);
  dropPieces(outline, disparities.map);
  fillGaps(outline);
  takeOffFringe(outline);
  return outline;
}

bool movesWithBody(const Outline& outline, const LevelDisparities& disparities, const ObjectView& view,
                   const StereoCamera& camera) {
  constexpr int kLeastMoving_gray = 2;
  constexpr int kLeastTold = 30;  // cells of which it can be told
  if (!view.before) return false;
  std::vector<int> known = outline.samples();
  std::erase_if(known, [&](int cell) { return disparities.map.disparity_px[cell] == DisparityMap::kNone; });
  int sum = 0, told = 0;
  for (const int rests : MotionEvidence(disparities, view, camera)(known)) sum -= rests, told += rests != 0;
  return told >= kLeastTold && sum > kLeastMoving_gray * MotionEvidence::kPixels * told;
}

Eigen::Vector3d cornerOf(const Eigen::Vector3d& least, const Eigen::Vector3d& most, int corner) {
  return {(corner & 1 ? most : least).x(), (corner & 2 ? most : least).y(), (corner & 4 ? most : least).z()};
}

std::optional<Box> projectedBox(const Eigen::Vector3d& least, const Eigen::Vector3d& most, const SE3& T_cam_body,
                                const StereoCamera& camera) {
  Box box{1e9, 1e9, -1e9, -1e9};
  for (int corner = 0; corner < 8; ++corner) {
    Eigen::Vector3d p_cam = T_cam_body * cornerOf(least, most, corner);
    constexpr double kNear_m = 0.5;  // what is behind the camera is cut off about there
    p_cam.z() = std::max(p_cam.z(), kNear_m);
    const auto uvd_px = camera.project(p_cam);
    if (!uvd_px) continue;
    box.left_px = std::min(box.left_px, uvd_px->x()), box.right_px = std::max(box.right_px, uvd_px->x());
    box.top_px = std::min(box.top_px, uvd_px->y()), box.bottom_px = std::max(box.bottom_px, uvd_px->y());
  }
  box.left_px = std::max(box.left_px, 0.0), box.top_px = std::max(box.top_px, 0.0);
  box.right_px = std::min(box.right_px, camera.width_px - 1.0);
  box.bottom_px = std::min(box.bottom_px, camera.height_px - 1.0);
  if (box.left_px >= box.right_px || box.top_px >= box.bottom_px) return std::nullopt;
  return box;
}

}  // namespace motorcade
