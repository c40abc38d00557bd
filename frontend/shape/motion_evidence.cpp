#include "frontend/shape/motion_evidence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/instruction_set.hpp"

#define HWY_TARGET_INCLUDE "frontend/shape/motion_evidence.cpp"
#include <hwy/foreach_target.h>

#include "frontend/image/pixel_lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

constexpr float kLeastShift = 1.5F;  // cells between where the body's motion and rest take a point

using Geometry = MotionEvidence::Geometry;

/// Places of cells in the frame before, and their depths there.
struct Places {
  Floats u, v, depth_m;
};

/// Places from which cells at rest may come: up to (du, dv) to both sides of the middle, along the epipolar line.
struct Stretch {
  Places middle;
  Floats least_depth_m, du, dv;
};

bool has3x3(const Image& image, int u, int v) {
  return u >= 1 && v >= 1 && u + 1 < image.width() && v + 1 < image.height();
}

/// The 3x3 pixels around a place of an image, to be compared with others.
SixteenBytes pixels3x3(const Image& image, int u, int v) {
  const auto row = [&](int y) HWY_ATTR {
    std::uint32_t pixels = 0;  // and one that does not count: behind an image's last row, too, bytes may be read
    std::memcpy(&pixels, image.row(y) + u - 1, sizeof pixels);
    return pixels & 0xFFFFFFU;
  };
  using Rows = std::uint32_t __attribute__((vector_size(16)));
  return SixteenBytes(Rows{row(v - 1), row(v), row(v + 1), 0});
}

/// Rays of cells, and their disparities at full size.
struct Rays {
  Floats x, y, disparities_px;

  std::array<Floats, 3> at(const Floats& z_m) const { return {x * z_m, y * z_m, z_m}; }
};

Places placesBefore(const Geometry& g, const MotionEvidence::Motion& motion, const std::array<Floats, 3>& p_cam) {
  std::array<Floats, 3> p;
  for (int i = 0; i < 3; ++i)
    p[i] = motion.R(i, 0) * p_cam[0] + motion.R(i, 1) * p_cam[1] + motion.R(i, 2) * p_cam[2] + motion.t[i];
  return {g.focal.x() * (p[0] / p[2]) + g.middle.x(), g.focal.y() * (p[1] / p[2]) + g.middle.y(), p[2]};
}

/// Places of rest for the disparities of cells, and for those that are less and more by the slack.
Stretch stretchOfRest(const Geometry& g, const Rays& rays) {
  const Places middle = placesBefore(g, g.rested, rays.at(g.fb / rays.disparities_px));
  if (g.slack.disparity_px == 0) return {middle, middle.depth_m, {0}, {0}};
  const Places end = placesBefore(g, g.rested, rays.at(g.fb / (rays.disparities_px + g.slack.disparity_px)));
  return {middle, lesser(middle.depth_m, end.depth_m), end.u - middle.u, end.v - middle.v};
}

/// Least distance between where a cell has moved from and where it may have rested.
float distanceBetween(const Places& moved, const Stretch& rested, int lane) {
  const float u = moved.u[lane] - rested.middle.u[lane], v = moved.v[lane] - rested.middle.v[lane];
  const float du = rested.du[lane], dv = rested.dv[lane], squared = du * du + dv * dv;
  const float along = squared > 0 ? std::clamp((u * du + v * dv) / squared, -1.F, 1.F) : 0;
  const float aside_u = u - along * du, aside_v = v - along * dv;
  return std::sqrt(aside_u * aside_u + aside_v * aside_v);
}

constexpr int kOutside = std::numeric_limits<int>::max();

/// Least difference from the image before within the slack's cells around a place; kOutside where these are not in it.
int leastAround(const Geometry& g, const SixteenBytes& now, float u_px, float v_px) {
  // Negative places are outside in any case. NOLINTNEXTLINE(bugprone-incorrect-roundings)
  const int u = static_cast<int>(u_px + 0.5F), v = static_cast<int>(v_px + 0.5F), slack = g.slack.cells;
  if (!has3x3(g.before, u - slack, v - slack) || !has3x3(g.before, u + slack, v + slack)) return kOutside;
  int least = kOutside;
  for (int j = -slack; j <= slack; ++j)
    for (int i = -slack; i <= slack; ++i) least = std::min(least, differenceOf(now, pixels3x3(g.before, u + i, v + j)));
  return least;
}

/// The same along a stretch; kOutside where a part of it is not in the image.
int leastAlong(const Geometry& g, const SixteenBytes& now, const Stretch& rested, int lane) {
  const float du = rested.du[lane], dv = rested.dv[lane], step_px = static_cast<float>(2 * g.slack.cells + 1);
  constexpr float kHalfACell = 0.5F;  // by which places are rounded, too
  const float reach = std::max(std::sqrt(du * du + dv * dv) - kHalfACell, 0.F);
  const int steps = static_cast<int>(std::ceil(reach / step_px));
  int least = kOutside;
  for (int step = -steps; step <= steps; ++step) {
    const float share = steps > 0 ? static_cast<float>(step) / static_cast<float>(steps) : 0;
    const int around = leastAround(g, now, rested.middle.u[lane] + share * du, rested.middle.v[lane] + share * dv);
    if (around == kOutside) return kOutside;
    least = std::min(least, around);
  }
  return least;
}

/// Zero where one of the places is outside its image.
int difference(const Geometry& g, int cell, const Places& moved, const Stretch& rested, int lane) {
  const PixelWindow& window = g.map.window;
  const int u = window.u0 + cell % window.width, v = window.v0 + cell / window.width;
  if (!has3x3(g.now, u, v)) return 0;
  const SixteenBytes now = pixels3x3(g.now, u, v);
  const int of_moved = leastAround(g, now, moved.u[lane], moved.v[lane]);
  if (of_moved == kOutside) return 0;
  const int of_rested = leastAlong(g, now, rested, lane);
  return of_rested == kOutside ? 0 : of_moved - of_rested;
}

/// Up to kFloatLanes cells.
void compare(const Geometry& g, std::span<const int> cells, std::int16_t* evidence) {
  std::array<float, kFloatLanes> columns{}, rows{}, disparities_px;
  disparities_px.fill(1);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const int row = cells[i] / g.map.window.width, column = cells[i] % g.map.window.width;
    columns[i] = static_cast<float>(g.map.window.u0 + column);
    rows[i] = static_cast<float>(g.map.window.v0 + row);
    disparities_px[i] = g.map.disparity_px[cells[i]];
  }
  const Rays rays{(load(columns.data()) - g.middle.x()) * (1 / g.focal.x()),
                  (load(rows.data()) - g.middle.y()) * (1 / g.focal.y()),
                  load(disparities_px.data()) * g.scale + g.offset_px};
  const Places moved = placesBefore(g, g.moved, rays.at(g.fb / rays.disparities_px));
  const Stretch rested = stretchOfRest(g, rays);
  constexpr auto kNear_m = static_cast<float>(StereoCamera::kMinDepth_m);
  const float least_shift = kLeastShift + static_cast<float>(2 * g.slack.cells);
  const unsigned visible = bitsOf((moved.depth_m >= kNear_m) & (rested.least_depth_m >= kNear_m));
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const int lane = static_cast<int>(i);
    const bool tells = (visible >> i & 1) != 0 && distanceBetween(moved, rested, lane) >= least_shift;
    evidence[i] = static_cast<std::int16_t>(tells ? difference(g, cells[i], moved, rested, lane) : 0);
  }
}

}  // namespace

void compareAll(const Geometry& g, std::span<const int> cells, std::int16_t* evidence) {
  for (std::size_t i = 0; i < cells.size(); i += kFloatLanes)
    compare(g, cells.subspan(i, std::min<std::size_t>(kFloatLanes, cells.size() - i)), evidence + i);
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(compareAll);

namespace {

constexpr int kLeastDifference = 5;  // gray levels by which rest explains the brightness better
constexpr int kAround = 2;           // cells on each side, that together tell whether one rests

/// Sums over the cells up to kAround away of values of a window, row after row.
class SumsAround {
 public:
  /// Zeros, to be set before the first row.
  explicit SumsAround(const PixelWindow& window)
      : values(window.area(), 0), window_(window), of_columns_(window.width + 2 * kAround, 0) {}

  void goTo(int row) {
    if (row == 0)
      for (int first = 0; first < kAround; ++first) addRow(first, 1);
    addRow(row + kAround, 1);
    addRow(row - kAround - 1, -1);
  }
  int at(int column) const {
    static_assert(kAround == 2);
    const std::int16_t* sums = of_columns_.data() + column;
    return sums[0] + sums[1] + sums[2] + sums[3] + sums[4];
  }
  /// In the row that was gone to.
  void clear(int column, int row) {
    std::int16_t& value = values[static_cast<std::size_t>(row) * window_.width + column];
    of_columns_[column + kAround] = static_cast<std::int16_t>(of_columns_[column + kAround] - value);
    value = 0;
  }

  std::vector<std::int16_t> values;

 private:
  void addRow(int row, int sign) {
    if (row < 0 || row >= window_.height) return;
    const std::int16_t* of_row = values.data() + static_cast<std::size_t>(row) * window_.width;
    std::int16_t* columns = of_columns_.data() + kAround;
    for (int u = 0; u < window_.width; ++u) columns[u] = static_cast<std::int16_t>(columns[u] + sign * of_row[u]);
  }

  PixelWindow window_;
  std::vector<std::int16_t> of_columns_;
};

MotionEvidence::Motion motionOf(const SE3& T_before_cam) {
  return {T_before_cam.rotation().cast<float>(), T_before_cam.translation().cast<float>()};
}

}  // namespace

MotionEvidence::MotionEvidence(const LevelDisparities& disparities, const ObjectView& view,
                               const ObjectView::Before& before, const StereoCamera& camera, const Slack& slack)
    : geometry_{.map = disparities.map,
                .now = before.now->levels[disparities.level],
                .before = before.before->levels[disparities.level],
                .slack = slack,
                .scale = static_cast<float>(1 << disparities.level),
                .offset_px = static_cast<float>(view.disparity_offset_px),
                .fb = static_cast<float>(camera.fx_px * camera.baseline_m),
                .focal = Eigen::Vector2d(camera.fx_px, camera.fy_px).cast<float>() /
                         static_cast<float>(1 << disparities.level),
                .middle = {toLevel(static_cast<float>(camera.cx_px), disparities.level),
                           toLevel(static_cast<float>(camera.cy_px), disparities.level)},
                .moved = motionOf(before.T_before_body * view.T_cam_body.inverse()),
                .rested = motionOf(before.T_before_cam)} {}

std::vector<std::int16_t> MotionEvidence::operator()(std::span<const int> cells) const {
  std::vector<std::int16_t> evidence(cells.size());
  MOTORCADE_KERNEL(compareAll)(geometry_, cells, evidence.data());
  return evidence;
}

/// Every other cell tells, as on a chessboard; one that is dropped no longer does, but what it told stands.
void dropResting(Outline& outline, const LevelDisparities& disparities, const ObjectView& view,
                 const StereoCamera& camera) {
  const int width = outline.window.width, height = outline.window.height;
  std::vector<int> telling;
  telling.reserve(outline.inside.size() / 2 + 1);
  for (int row = 0; row < height; ++row)
    for (int column = row % 2; column < width; column += 2)
      if (outline.at(column, row)) telling.push_back(row * width + column);
  const std::vector<std::int16_t> rests_rather = MotionEvidence(disparities, view, *view.before, camera)(telling);
  if (std::ranges::none_of(rests_rather, [](std::int16_t rests) { return rests > 0; })) return;
  SumsAround evidence(outline.window), tells(outline.window);
  for (std::size_t i = 0; i < telling.size(); ++i)
    evidence.values[telling[i]] = rests_rather[i], tells.values[telling[i]] = 1;
  constexpr int kLeast = kLeastDifference * MotionEvidence::kPixels;
  for (int row = 0; row < height; ++row) {
    evidence.goTo(row), tells.goTo(row);
    for (int column = 0; column < width; ++column) {
      if (!outline.at(column, row) || evidence.at(column) <= kLeast * tells.at(column)) continue;
      outline.inside[static_cast<std::size_t>(row) * width + column] = 0;
      tells.clear(column, row);
    }
  }
}

}  // namespace motorcade
#endif
