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

/// Smooths an outline: a cell becomes what most of its 3x3 neighbors and itself are.
void smooth(Outline& outline) {
  const int width = outline.window.width, height = outline.window.height;
  std::vector<std::uint8_t> across(static_cast<std::size_t>(width) * (height + 2), 0);  // how many of three in a row
  for (int row = 0; row < height; ++row) {
    const std::uint8_t* inside = outline.inside.data() + static_cast<std::size_t>(row) * width;
    std::uint8_t* sums = across.data() + static_cast<std::size_t>(row + 1) * width;
    for (int column = 0; column < width; ++column) sums[column] = inside[column] != kOutside;
    for (int column = 1; column < width; ++column) sums[column] += inside[column - 1] != kOutside;
    for (int column = 0; column + 1 < width; ++column) sums[column] += inside[column + 1] != kOutside;
  }
  for (int row = 0; row < height; ++row) {
    std::uint8_t* cells = outline.inside.data() + static_cast<std::size_t>(row) * width;
    const std::uint8_t *above = across.data() + static_cast<std::size_t>(row) * width, *here = above + width,
                       *below = here + width;
    const int rows = 1 + (row > 0 ? 1 : 0) + (row + 1 < height ? 1 : 0);
    const auto decide = [&](int column, int columns) {
      const int sum = above[column] + here[column] + below[column];
      cells[column] = 2 * sum <= rows * columns ? kOutside : std::max(cells[column], kPossible);
    };
    decide(0, std::min(width, 2));
    for (int column = 1; column + 1 < width; ++column) decide(column, 3);
    if (width > 1) decide(width - 1, 2);
  }
}

/// Connected pieces of an outline: the number of its piece for each cell.
class Pieces {
 public:
  Pieces(const Outline& outline, const DisparityMap& map)
      : width_(outline.window.width),
        stride_(width_ + 2),
        piece_of_(static_cast<std::size_t>(stride_) * (outline.window.height + 2), kNone),
        disparity_px_(piece_of_.size(), DisparityMap::kNone) {
    for (int row = 0; row < outline.window.height; ++row) {
      const std::size_t from = static_cast<std::size_t>(row) * width_;
      std::copy_n(map.disparity_px.begin() + static_cast<std::ptrdiff_t>(from), width_, &disparity_px_[placeOf(row)]);
      for (int column = 0; column < width_; ++column)
        if (outline.inside[from + column] != kOutside) piece_of_[placeOf(row) + column] = kOpen;
    }
  }

  /// Fills the piece of a cell that is in none yet, and visits each of its cells; false where there is no such cell.
  template <class Visit>
  bool fill(int row, int column, int id, const Visit& visit) {
    const int seed = placeOf(row) + column;
    if (piece_of_[seed] != kOpen) return false;
    open_.assign(1, seed);
    piece_of_[seed] = id;
    while (!open_.empty()) {
      const int at = open_.back();
      open_.pop_back();
      visit((at / stride_ - 1) * width_ + at % stride_ - 1);
      for (const int next : {at - 1, at + 1, at - stride_, at + stride_}) {
        if (piece_of_[next] != kOpen || !areConnected(disparity_px_[at], disparity_px_[next])) continue;
        piece_of_[next] = id;
        open_.push_back(next);
      }
    }
    return true;
  }
  /// Piece of a cell; negative outside.
  int at(int row, int column) const { return piece_of_[placeOf(row) + column]; }

 private:
  static constexpr int kNone = -2, kOpen = -1;  // outside, and around the window; in no piece yet

  static bool areConnected(float a_px, float b_px) {
    const bool known = a_px != DisparityMap::kNone && b_px != DisparityMap::kNone;
    return !known || std::abs(a_px - b_px) <= kConnected_px;
  }
  int placeOf(int row) const { return (row + 1) * stride_ + 1; }

  int width_, stride_;
  std::vector<int> piece_of_;
  std::vector<float> disparity_px_;
  std::vector<int> open_;
};

/// Keeps the connected piece that has most in the usual volume, and those that lie there for the most part.
void dropPieces(Outline& outline, const DisparityMap& map) {
  Pieces pieces(outline, map);
  std::vector<int> sizes, usual;
  for (int row = 0; row < outline.window.height; ++row)
    for (int column = 0; column < outline.window.width; ++column) {
      int size = 0, usual_cells = 0;
      const bool found = pieces.fill(row, column, static_cast<int>(sizes.size()), [&](int cell) {
        ++size;
        usual_cells += outline.inside[cell] == kUsual;
      });
      if (found) sizes.push_back(size), usual.push_back(usual_cells);
    }
  if (sizes.empty()) return;
  const auto main = static_cast<int>(std::ranges::max_element(usual) - usual.begin());
  std::vector<std::uint8_t> keeps(sizes.size());
  for (std::size_t id = 0; id < sizes.size(); ++id)
    keeps[id] = static_cast<int>(id) == main || usual[id] > kLeastUsual * sizes[id];
  for (int row = 0; row < outline.window.height; ++row)
    for (int column = 0; column < outline.window.width; ++column) {
      const int id = pieces.at(row, column);
      outline.inside[static_cast<std::size_t>(row) * outline.window.width + column] = id >= 0 ? keeps[id] : 0;
    }
}

/// First and last of so many cells that are inside; first beyond last where there is none.
template <class IsInside>
std::pair<int, int> spanOf(int cells, const IsInside& is_inside) {
  int first = 0, last = cells - 1;
  while (first < cells && !is_inside(first)) ++first;
  while (last > first && !is_inside(last)) --last;
  return first < cells ? std::pair(first, last) : std::pair(cells, -1);
}

/// Fills gaps: a cell with cells of the object on all four sides is its own. Windows and smooth paint give no
/// disparity, or a wrong one.
void fillGaps(Outline& outline) {
  const auto rows = outline.spansOfRows(), columns = outline.spansOfColumns();
  for (int row = 0; row < outline.window.height; ++row)
    for (int column = rows[row].first; column <= rows[row].second; ++column)
      if (columns[column].first <= row && row <= columns[column].second)
        outline.inside[static_cast<std::size_t>(row) * outline.window.width + column] = 1;
}

/// Takes off the fringe that the compared windows add to objects; at the left, so does what only the left image sees.
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
  const Spans rows = spansOfRows();
  for (int row = 0; row < window.height; ++row) {
    const auto [first, last] = rows[row];
    if (last < 0) continue;
    left = std::min(left, first), right = std::max(right, last);
    top = std::min(top, row), bottom = row;
  }
  return {left, top, right - left + 1, bottom - top + 1};
}

Outline::Spans Outline::spansOfRows() const {
  Spans spans;
  spans.reserve(window.height);
  for (int row = 0; row < window.height; ++row)
    spans.push_back(spanOf(window.width, [&](int column) { return at(column, row); }));
  return spans;
}

Outline::Spans Outline::spansOfColumns() const {
  Spans spans;
  spans.reserve(window.width);
  for (int column = 0; column < window.width; ++column)
    spans.push_back(spanOf(window.height, [&](int row) { return at(column, row); }));
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
  for (const int rests : MotionEvidence(disparities, view, *view.before, camera)(known))
    sum -= rests, told += rests != 0;
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
