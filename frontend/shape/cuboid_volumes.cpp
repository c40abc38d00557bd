#include "frontend/shape/cuboid_volumes.hpp"

#include <algorithm>
#include <cstring>

namespace motorcade {
namespace {

constexpr double kGrowth_m = 0.6;  // by which an outline may pass the volume that was thought possible, along the road
constexpr double kSlack_m = 0.2;   // beyond the volume that the cuboid may fill
constexpr float kLeastHeight_m = 0.15F;  // above the road, below which a point may be the road's

using EightBytes = std::uint8_t __attribute__((vector_size(kFloatLanes)));

const Floats kEveryFloatLane{0, 1, 2, 3, 4, 5, 6, 7};

std::array<Floats, 3> turned(const Eigen::Matrix3f& R, const std::array<Floats, 3>& p) {
  std::array<Floats, 3> result;
  for (int i = 0; i < 3; ++i) result[i] = R(i, 0) * p[0] + R(i, 1) * p[1] + R(i, 2) * p[2];
  return result;
}

}  // namespace

CuboidVolumes::CuboidVolumes(const LevelDisparities& disparities, const ObjectView& view, const StereoCamera& camera)
    : disparities_(disparities),
      scale_(static_cast<float>(1 << disparities.level)),
      offset_px_(static_cast<float>(view.disparity_offset_px)),
      fb_(static_cast<float>(camera.fx_px * camera.baseline_m)),
      first_ray_(static_cast<float>((disparities.u_px(0) - camera.cx_px) / camera.fx_px),
                 static_cast<float>((disparities.v_px(0) - camera.cy_px) / camera.fy_px)),
      ray_step_(static_cast<float>((1 << disparities.level) / camera.fx_px),
                static_cast<float>((1 << disparities.level) / camera.fy_px)),
      ground_normal_(view.ground.normal_cam.cast<float>()),
      ground_height_m_(static_cast<float>(view.ground.height_m)),
      R_body_cam_(view.T_cam_body.rotation().transpose().cast<float>()),
      origin_((-view.T_cam_body.rotation().transpose() * view.T_cam_body.translation()).cast<float>()) {
  const Eigen::Vector3d growth_m(kGrowth_m, kGrowth_m, kSlack_m), slack_m = Eigen::Vector3d::Constant(kSlack_m);
  possible_ = {(view.box.possible_least - growth_m).cast<float>(), (view.box.possible_most + growth_m).cast<float>()};
  usual_ = {(view.box.usual_least - slack_m).cast<float>(), (view.box.usual_most + slack_m).cast<float>()};
  boundDisparities(view, camera);
  addOthers(view, camera);
}

/// What is nearer than the volume's nearest corner, or farther than its farthest, need not be looked at closely.
void CuboidVolumes::boundDisparities(const ObjectView& view, const StereoCamera& camera) {
  constexpr double kNear_m = 0.5, kSafety = 3;
  double near_m = 1e9, far_m = kNear_m;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d at = cornerOf(possible_.least.cast<double>(), possible_.most.cast<double>(), corner);
    const double z = (view.T_cam_body * at).z();
    near_m = std::min(near_m, z), far_m = std::max(far_m, z);
  }
  const double fb = camera.fx_px * camera.baseline_m,
               slack_px = kSafety * 2 * kCoarseSigma_px * (1 << disparities_.level);
  most_px_ = static_cast<float>(fb / std::max(near_m, kNear_m) + slack_px);
  const double least_px = fb / far_m - slack_px;
  least_px_ = least_px < slack_px ? 0 : static_cast<float>(least_px);  // so small that it may be anything
}

/// Those whose cuboids are in the window.
void CuboidVolumes::addOthers(const ObjectView& view, const StereoCamera& camera) {
  const PixelWindow& window = disparities_.map.window;
  for (const ObjectView::Other& other : view.others) {
    const auto box = projectedBox(other.least, other.most, other.T_body_cam.inverse(), camera);
    if (!box || box->right_px < disparities_.u_px(0) || box->left_px > disparities_.u_px(window.width - 1) ||
        box->bottom_px < disparities_.v_px(0) || box->top_px > disparities_.v_px(window.height - 1))
      continue;
    others_.push_back({other.T_body_cam.rotation().cast<float>(),
                       other.T_body_cam.translation().cast<float>(),
                       {other.least.cast<float>(), other.most.cast<float>()}});
  }
}

void CuboidVolumes::tell(double sigma_px, std::span<std::uint8_t> cells) const {
  const PixelWindow& window = disparities_.map.window;
  const float slack_per_m = 2 * static_cast<float>(sigma_px) * scale_ / fb_;
  for (int row = 0; row < window.height; ++row)
    for (int column = 0; column < window.width; column += kFloatLanes) {
      const std::size_t at = static_cast<std::size_t>(row) * window.width + column,
                        count = std::min(kFloatLanes, window.width - column);
      std::array<std::uint8_t, kFloatLanes> told{};
      std::copy_n(cells.data() + at, count, told.data());
      if (std::ranges::none_of(told, [](std::uint8_t cell) { return cell != kOutside; })) continue;
      Floats disparities_px{};
      std::memcpy(&disparities_px, disparities_.map.disparity_px.data() + at, count * sizeof(float));
      const Points rays{first_ray_.x() + ray_step_.x() * (kEveryFloatLane + static_cast<float>(column)),
                        allFloats(first_ray_.y() + ray_step_.y() * static_cast<float>(row)), allFloats(1)};
      tellLanes(rays, slack_per_m, disparities_px, told.data());
      std::copy_n(told.data(), count, cells.data() + at);
    }
}

void CuboidVolumes::tellLanes(const Points& rays, float slack_per_m, const Floats& disparities_px,
                              std::uint8_t* cells) const {
  EightBytes asked;
  std::memcpy(&asked, cells, sizeof asked);
  const Floats d = disparities_px * scale_ + offset_px_;
  FloatMask possible = (__builtin_convertvector(asked, FloatMask) != kOutside) &
                       (disparities_px != DisparityMap::kNone) & (d > 0) & (d >= least_px_) & (d <= most_px_);
  EightBytes told{};
  if (anyOf(possible)) {
    const Floats z = fb_ / (possible ? d : allFloats(1)), slack_m = z * z * slack_per_m;
    possible &=
        ground_height_m_ - z * (ground_normal_.x() * rays[0] + ground_normal_.y() * rays[1] + ground_normal_.z()) >=
        kLeastHeight_m;
    Points inverse = turned(R_body_cam_, rays);
    for (Floats& direction : inverse)
      direction = 1 / ((direction > 1e-9F) | (direction < -1e-9F) ? direction : allFloats(1e-9F));
    possible &= mayBe(possible_, inverse, z - slack_m, z + slack_m);
    if (!others_.empty() && anyOf(possible)) possible &= ~areOthers({z * rays[0], z * rays[1], z});
    if (anyOf(possible)) {
      const FloatMask usual = possible & mayBe(usual_, inverse, z - slack_m, z + slack_m);
      told = __builtin_convertvector(-(possible + usual), EightBytes);
    }
  }
  std::memcpy(cells, &told, sizeof told);
}

/// Does a ray meet a cuboid between the nearest and the farthest that its cell's point may be?
FloatMask CuboidVolumes::mayBe(const Cuboid& cuboid, const Points& inverse_directions, const Floats& nearest,
                               const Floats& farthest) const {
  Floats begin{}, end = allFloats(1e9F);
  for (int axis = 0; axis < 3; ++axis) {
    const Floats one = (cuboid.least[axis] - origin_[axis]) * inverse_directions[axis],
                 other = (cuboid.most[axis] - origin_[axis]) * inverse_directions[axis];
    begin = greater(begin, lesser(one, other)), end = lesser(end, greater(one, other));
  }
  return (begin <= end) & (end >= nearest) & (begin <= farthest);
}

/// Do points lie in another object's cuboid?
FloatMask CuboidVolumes::areOthers(const Points& p_cam) const {
  FloatMask any{};
  for (const Other& other : others_) {
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

}  // namespace motorcade
