#include "frontend/shape/cuboid_volumes.hpp"

#include <algorithm>
#include <cstring>

#include "core/instruction_set.hpp"

#define HWY_TARGET_INCLUDE "frontend/shape/cuboid_volumes.cpp"
#include <hwy/foreach_target.h>

#include "frontend/image/pixel_lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

constexpr float kLeastHeight_m = 0.15F;  // above the road, below which a point may be the road's

using Geometry = CuboidVolumes::Geometry;
using Points = std::array<Floats, 3>;

Floats columnNumbers() {
  static constexpr float kNumbers[]{0, 1, 2, 3, 4, 5, 6, 7};
  return load(kNumbers);
}

Points turned(const Eigen::Matrix3f& R, const Points& p) {
  Points result;
  for (int i = 0; i < 3; ++i) result[i] = R(i, 0) * p[0] + R(i, 1) * p[1] + R(i, 2) * p[2];
  return result;
}

/// Does a ray meet a cuboid between the nearest and the farthest that its cell's point may be?
FloatMask mayBe(const Geometry& g, const CuboidVolumes::Cuboid& cuboid, const Points& inverse_directions,
                const Floats& nearest, const Floats& farthest) {
  Floats begin{}, end = 1e9F;
  for (int axis = 0; axis < 3; ++axis) {
    const Floats one = (cuboid.least[axis] - g.origin[axis]) * inverse_directions[axis],
                 other = (cuboid.most[axis] - g.origin[axis]) * inverse_directions[axis];
    begin = greater(begin, lesser(one, other)), end = lesser(end, greater(one, other));
  }
  return (begin <= end) & (end >= nearest) & (begin <= farthest);
}

/// Do points lie in another object's cuboid?
FloatMask areOthers(const Geometry& g, const Points& p_cam) {
  FloatMask any{};
  for (const CuboidVolumes::Other& other : g.others) {
    const Points p_body = turned(other.R_body_cam, p_cam);
    FloatMask inside = ~FloatMask{};
    for (int axis = 0; axis < 3; ++axis) {
      const Floats at = p_body[axis] + other.origin[axis];
      inside &= (at > other.cuboid.least[axis]) & (at < other.cuboid.most[axis]);
    }
    any |= inside;
  }
  return any;
}

/// Eight cells of a row.
void tellLanes(const Geometry& g, const Points& rays, float slack_per_m, const Floats& disparities_px,
               std::uint8_t* cells) {
  std::array<std::int32_t, kFloatLanes> asked;
  std::copy_n(cells, kFloatLanes, asked.begin());
  std::fill_n(cells, kFloatLanes, CuboidVolumes::kOutside);
  const Floats d = disparities_px * g.scale + g.offset_px;
  FloatMask possible = (load(asked.data()) != std::int32_t{CuboidVolumes::kOutside}) &
                       (disparities_px != DisparityMap::kNone) & (d > 0.0F) & (d >= g.least_px) & (d <= g.most_px);
  if (!anyOf(possible)) return;
  const Floats z = g.fb / choose(possible, d, 1.0F), slack_m = z * z * slack_per_m;
  const Eigen::Vector3f& normal = g.ground_normal;
  possible &= g.ground_height_m - z * (normal.x() * rays[0] + normal.y() * rays[1] + normal.z()) >= kLeastHeight_m;
  Points inverse = turned(g.R_body_cam, rays);
  for (Floats& direction : inverse)
    direction = 1.0F / choose((direction > 1e-9F) | (direction < -1e-9F), direction, 1e-9F);
  possible &= mayBe(g, g.possible, inverse, z - slack_m, z + slack_m);
  if (!g.others.empty() && anyOf(possible)) possible &= ~areOthers(g, {z * rays[0], z * rays[1], z});
  if (!anyOf(possible)) return;
  const unsigned in_possible = bitsOf(possible),
                 in_usual = bitsOf(possible & mayBe(g, g.usual, inverse, z - slack_m, z + slack_m));
  for (int i = 0; i < kFloatLanes; ++i)
    cells[i] = static_cast<std::uint8_t>((in_possible >> i & 1) + (in_usual >> i & 1));
}

}  // namespace

void tellCells(const Geometry& g, const DisparityMap& map, float slack_per_m, std::span<std::uint8_t> cells) {
  const PixelWindow& window = map.window;
  for (int row = 0; row < window.height; ++row)
    for (int column = 0; column < window.width; column += kFloatLanes) {
      const std::size_t at = static_cast<std::size_t>(row) * window.width + column,
                        count = std::min(kFloatLanes, window.width - column);
      std::array<std::uint8_t, kFloatLanes> told{};
      std::copy_n(cells.data() + at, count, told.data());
      if (std::ranges::none_of(told, [](std::uint8_t cell) { return cell != CuboidVolumes::kOutside; })) continue;
      std::array<float, kFloatLanes> disparities_px{};
      std::memcpy(&disparities_px, map.disparity_px.data() + at, count * sizeof(float));
      const Points rays{g.first_ray.x() + g.ray_step.x() * (columnNumbers() + static_cast<float>(column)),
                        g.first_ray.y() + g.ray_step.y() * static_cast<float>(row), 1.0F};
      tellLanes(g, rays, slack_per_m, load(disparities_px.data()), told.data());
      std::copy_n(told.data(), count, cells.data() + at);
    }
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(tellCells);

namespace {

constexpr double kGrowth_m = 0.6;  // by which an outline may pass the volume that was thought possible, along the road
constexpr double kSlack_m = 0.2;   // beyond the volume that the cuboid may fill

}  // namespace

CuboidVolumes::CuboidVolumes(const LevelDisparities& disparities, const ObjectView& view, const StereoCamera& camera)
    : disparities_(disparities),
      geometry_{.scale = static_cast<float>(1 << disparities.level),
                .offset_px = static_cast<float>(view.disparity_offset_px),
                .fb = static_cast<float>(camera.fx_px * camera.baseline_m),
                .first_ray = {static_cast<float>((disparities.u_px(0) - camera.cx_px) / camera.fx_px),
                              static_cast<float>((disparities.v_px(0) - camera.cy_px) / camera.fy_px)},
                .ray_step = {static_cast<float>((1 << disparities.level) / camera.fx_px),
                             static_cast<float>((1 << disparities.level) / camera.fy_px)},
                .ground_normal = view.ground.normal_cam.cast<float>(),
                .ground_height_m = static_cast<float>(view.ground.height_m),
                .R_body_cam = view.T_cam_body.rotation().transpose().cast<float>(),
                .origin = (-view.T_cam_body.rotation().transpose() * view.T_cam_body.translation()).cast<float>()} {
  const Eigen::Vector3d growth_m(kGrowth_m, kGrowth_m, kSlack_m), slack_m = Eigen::Vector3d::Constant(kSlack_m);
  geometry_.possible = {(view.box.possible_least - growth_m).cast<float>(),
                        (view.box.possible_most + growth_m).cast<float>()};
  geometry_.usual = {(view.box.usual_least - slack_m).cast<float>(), (view.box.usual_most + slack_m).cast<float>()};
  boundDisparities(view, camera);
  addOthers(view, camera);
}

/// What is nearer than the volume's nearest corner, or farther than its farthest, need not be looked at closely.
void CuboidVolumes::boundDisparities(const ObjectView& view, const StereoCamera& camera) {
  constexpr double kNear_m = 0.5, kSafety = 3;
  double near_m = 1e9, far_m = kNear_m;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d at =
        cornerOf(geometry_.possible.least.cast<double>(), geometry_.possible.most.cast<double>(), corner);
    const double z = (view.T_cam_body * at).z();
    near_m = std::min(near_m, z), far_m = std::max(far_m, z);
  }
  const double fb = camera.fx_px * camera.baseline_m,
               slack_px = kSafety * 2 * kCoarseSigma_px * (1 << disparities_.level);
  geometry_.most_px = static_cast<float>(fb / std::max(near_m, kNear_m) + slack_px);
  const double least_px = fb / far_m - slack_px;
  geometry_.least_px = least_px < slack_px ? 0 : static_cast<float>(least_px);  // so small that it may be anything
}

/// Those whose cuboids are in the window.
void CuboidVolumes::addOthers(const ObjectView& view, const StereoCamera& camera) {
  const PixelWindow& window = disparities_.map.window;
  for (const ObjectView::Other& other : view.others) {
    const auto box = projectedBox(other.least, other.most, other.T_body_cam.inverse(), camera);
    if (!box || box->right_px < disparities_.u_px(0) || box->left_px > disparities_.u_px(window.width - 1) ||
        box->bottom_px < disparities_.v_px(0) || box->top_px > disparities_.v_px(window.height - 1))
      continue;
    geometry_.others.push_back({other.T_body_cam.rotation().cast<float>(),
                                other.T_body_cam.translation().cast<float>(),
                                {other.least.cast<float>(), other.most.cast<float>()}});
  }
}

void CuboidVolumes::tell(double sigma_px, std::span<std::uint8_t> cells) const {
  const float slack_per_m = 2 * static_cast<float>(sigma_px) * geometry_.scale / geometry_.fb;
  MOTORCADE_KERNEL(tellCells)(geometry_, disparities_.map, slack_per_m, cells);
}

}  // namespace motorcade
#endif
