#include "frontend/shape/outline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "frontend/shape/motion_evidence.hpp"
#include "frontend/shape/ray_in_box.hpp"

namespace motorcade {
namespace {

constexpr double kDisparitySigma_px = 0.25;  // of a dense disparity, in pixels of its level
constexpr double kCoarseSigma_px = 1.2;      // before it is refined
constexpr double kGrowth_m = 0.6;  // by which an outline may pass the volume that was thought possible, along the road
constexpr double kSlack_m = 0.2;   // beyond the volume that the cuboid may fill
constexpr float kConnected_px = 1.0F;             // of the level: between neighbors on one surface
constexpr double kLeastHeight_m = 0.15;           // above the road, below which a point may be the road's
constexpr int kFringeLeft = 2, kFringeRight = 1;  // cells
constexpr double kLeastUsual = 0.7;               // of a piece's cells, so that it is one of the object's
constexpr std::uint8_t kOutside = 0, kPossible = 1, kUsual = 2;  // in which volume a cell's point lies

constexpr float kLeastDifference = 5;  // gray levels by which rest explains the brightness better

/// Does a point lie in another object's cuboid?
bool isOthers(const ObjectView& view, const Eigen::Vector3d& p_cam) {
  return std::ranges::any_of(view.others, [&](const ObjectView::Other& other) {
    const Eigen::Vector3d p_body = other.T_body_cam * p_cam;
    return (p_body.array() > other.least.array()).all() && (p_body.array() < other.most.array()).all();
  });
}

/// Tells where the points of cells are: in the volume that the cuboid may fill, and in the one that it usually fills.
class CuboidVolumes {
 public:
  CuboidVolumes(const LevelDisparities& disparities, const ObjectView& view, const StereoCamera& camera)
      : disparities_(disparities), view_(view), camera_(camera) {
    const Eigen::Array3d growth_m(kGrowth_m, kGrowth_m, kSlack_m);
    least_ = view.box.possible_least.array() - growth_m, most_ = view.box.possible_most.array() + growth_m;
    usual_least_ = view.box.usual_least.array() - kSlack_m, usual_most_ = view.box.usual_most.array() + kSlack_m;
    R_body_cam_ = view.T_cam_body.rotation().transpose();
    origin_ = -R_body_cam_ * view.T_cam_body.translation();
    boundDisparities();
  }

  /// kOutside where the disparity is unknown, or wrong by more than `sigma_px` twice over [px of the level].
  std::uint8_t operator()(int column, int row, double sigma_px) const {
    const auto disparity_px = disparities_.disparity_px(column, row);
    if (!disparity_px) return kOutside;
    const double d = *disparity_px + view_.disparity_offset_px;
    if (d <= 0 || d < least_px_ || d > most_px_) return kOutside;
    const double z = camera_.fx_px * camera_.baseline_m / d, slack_m = 2 * z * sigma_px * (1 << disparities_.level) / d;
    const Eigen::Vector3d ray((disparities_.u_px(column) - camera_.cx_px) / camera_.fx_px,
                              (disparities_.v_px(row) - camera_.cy_px) / camera_.fy_px, 1);
    if (view_.ground.heightOf_m(z * ray) < kLeastHeight_m) return kOutside;
    const Eigen::Vector3d direction = R_body_cam_ * ray;
    const auto holds = [&](const Interval& within) {
      return within.begin <= within.end && within.end >= z - slack_m && within.begin <= z + slack_m;
    };
    if (!holds(insideOf(least_, most_, origin_, direction)) || isOthers(view_, z * ray)) return kOutside;
    return holds(insideOf(usual_least_, usual_most_, origin_, direction)) ? kUsual : kPossible;
  }

 private:
  /// What is nearer than the volume's nearest corner, or farther than its farthest, need not be looked at closely.
  void boundDisparities() {
    constexpr double kNear_m = 0.5, kSafety = 2.5;
    double near_m = 1e9, far_m = kNear_m;
    for (int corner = 0; corner < 8; ++corner) {
      const double z = (view_.T_cam_body * cornerOf(least_, most_, corner)).z();
      near_m = std::min(near_m, z), far_m = std::max(far_m, z);
    }
    const double fb = camera_.fx_px * camera_.baseline_m,
                 slack_px = kSafety * 2 * kCoarseSigma_px * (1 << disparities_.level);
    most_px_ = fb / std::max(near_m, kNear_m) + slack_px;
    least_px_ = fb / far_m - slack_px;
    if (least_px_ < slack_px) least_px_ = 0;  // so small that it may be anything
  }

  const LevelDisparities& disparities_;
  const ObjectView& view_;
  const StereoCamera& camera_;
  double least_px_ = 0, most_px_ = 0;
  Eigen::Vector3d least_, most_, usual_least_, usual_most_, origin_;
  Eigen::Matrix3d R_body_cam_;
};

/// Cells around which the brightness rests rather than moves with the body. Every other cell tells, as on a chessboard.
void dropResting(Outline& outline, const LevelDisparities& disparities, const ObjectView& view,
                 const StereoCamera& camera) {
  const int width = outline.window.width, height = outline.window.height;
  const MotionEvidence rests_rather(disparities, view, camera);
  std::vector<float> evidence(outline.inside.size(), 0);
  const auto tells = [&](int column, int row) { return (row + column) % 2 == 0 && outline.at(column, row); };
  bool any = false;
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column)
      if (tells(column, row)) {
        const float rests = rests_rather(column, row);
        evidence[static_cast<std::size_t>(row) * width + column] = rests;
        any |= rests > 0;
      }
  if (!any) return;
  constexpr int kAround = 2;
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      if (!outline.at(column, row)) continue;
      float sum = 0;
      int cells = 0;
      for (int y = std::max(row - kAround, 0); y <= std::min(row + kAround, height - 1); ++y)
        for (int x = std::max(column - kAround, 0); x <= std::min(column + kAround, width - 1); ++x)
          sum += evidence[static_cast<std::size_t>(y) * width + x], cells += tells(x, y);
      if (sum > kLeastDifference * static_cast<float>(cells))
        outline.inside[static_cast<std::size_t>(row) * width + column] = kOutside;
    }
}

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
  const CuboidVolumes volumes(disparities, view, camera);
  const PixelWindow& window = disparities.map.window;
  std::vector<int> cells;
  for (int row = 0; row < window.height; ++row)
    for (int column = 0; column < window.width; ++column)
      if (volumes(column, row, kCoarseSigma_px) != kOutside) cells.push_back(row * window.width + column);
  return cells;
}

Outline findOutline(const LevelDisparities& disparities, std::span<const int> cells, const ObjectView& view,
                    const StereoCamera& camera) {
  Outline outline{.window = disparities.map.window, .inside = {}};
  outline.inside.resize(static_cast<std::size_t>(outline.window.area()), kOutside);
  const CuboidVolumes volumes(disparities, view, camera);
  for (const int cell : cells)
    outline.inside[cell] = volumes(cell % outline.window.width, cell / outline.window.width, kDisparitySigma_px);
  if (view.before) dropResting(outline, disparities, view, camera);
  smooth(outline);
  dropPieces(outline, disparities.map);
  fillGaps(outline);
  takeOffFringe(outline);
  return outline;
}

bool movesWithBody(const Outline& outline, const LevelDisparities& disparities, const ObjectView& view,
                   const StereoCamera& camera) {
  constexpr double kLeastMoving_gray = 2;
  constexpr int kLeastTold = 30;  // cells of which it can be told
  if (!view.before) return false;
  const MotionEvidence rests_rather(disparities, view, camera);
  double sum = 0;
  int told = 0;
  for (const int cell : outline.samples()) {
    const int column = cell % outline.window.width, row = cell / outline.window.width;
    if (!disparities.disparity_px(column, row)) continue;
    const float rests = rests_rather(column, row);
    sum -= rests, told += rests != 0;
  }
  return told >= kLeastTold && sum > kLeastMoving_gray * told;
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
