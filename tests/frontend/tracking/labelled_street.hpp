#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "frontend/image/image_pyramid.hpp"
#include "frontend/tracking/look_back.hpp"
#include "frontend/tracking/region_flow.hpp"
#include "tests/frontend/texture.hpp"
#include "tests/support/noise.hpp"

namespace motorcade::test {

/// A rig of few pixels, so that its images are quickly rendered.
inline constexpr StereoCamera kNarrowRig{
    .fx_px = 400, .fy_px = 400, .cx_px = 120, .cy_px = 80, .baseline_m = 0.5, .width_px = 240, .height_px = 160};

/// A smooth random pattern of two grain sizes, quicker than a sum of waves. Repeats itself every 256 px.
class GrainTexture {
 public:
  explicit GrainTexture(std::uint64_t seed) {
    Noise noise(seed);
    for (double& value : values_) value = noise.uniform(-1, 1);
  }
  /// Gray level, around 128.
  double operator()(double x_px, double y_px) const {
    constexpr double kFine_px = 4, kCoarse_px = 12, kContrast_gray = 50;
    return 128 + kContrast_gray * (at(x_px / kFine_px, y_px / kFine_px) + at(x_px / kCoarse_px, y_px / kCoarse_px));
  }

 private:
  static constexpr int kSide = 64;
  double valueOf(int column, int row) const { return values_[(row & (kSide - 1)) * kSide + (column & (kSide - 1))]; }
  double at(double x, double y) const {
    const int column = static_cast<int>(std::floor(x)), row = static_cast<int>(std::floor(y));
    const auto smooth = [](double t) { return t * t * (3 - 2 * t); };
    const double along = smooth(x - column), down = smooth(y - row);
    return std::lerp(std::lerp(valueOf(column, row), valueOf(column + 1, row), along),
                     std::lerp(valueOf(column, row + 1), valueOf(column + 1, row + 1), along), down);
  }
  std::array<double, kSide * kSide> values_;
};

/// An upright board that walks to the right before a wall, both textured, as a stereo camera sees them that drives
/// ahead and turns to the right. The world's z axis is where it looked in the first frame.
class LabelledStreet {
 public:
  static constexpr double kBoard_m = 10, kWall_m = 22;  // from the origin of the world, along its z axis
  static constexpr double kFrame_s = 0.1;
  static constexpr int kNow = 5;  // the newest frame; the others are remembered
  struct Board {
    double walk_mps = 1.4;
    double width_m = 0.6, height_m = 1.7;
    unsigned seed = 1;  // of textures and noise
  };
  explicit LabelledStreet(const Board& board)
      : board_(board), board_texture_(100 + board.seed), wall_texture_(200 + board.seed) {
    for (int frame = 0; frame < kNow; ++frame) past.remember(scene(frame, {}, {}), T_world_cam(frame), {}, {});
  }

  static SE3 T_world_cam(int frame) {
    constexpr double kStep_m = 0.4, kTurn_rad = 0.004;
    return {expSO3({0, kTurn_rad * frame, 0}), {0, 0, kStep_m * frame}};
  }
  static SE3 T_world_cam() { return T_world_cam(kNow); }
  Eigen::Vector3d velocity_cam_mps() const {
    return T_world_cam().rotation().transpose() * Eigen::Vector3d(board_.walk_mps, 0, 0);
  }
  /// Projection of a place on the board, from its middle, in the newest frame.
  Eigen::Vector3d onBoard_px(double right_m, double down_m) const {
    return seenNow_px(middle_m(kNow) + Eigen::Vector3d(right_m, down_m, 0));
  }
  static Eigen::Vector3d onWall_px(double x_m, double y_m) { return seenNow_px({x_m, y_m, kWall_m}); }
  /// Box around so much of a surface to each side of a place, in the newest frame.
  static Box around(const Eigen::Vector3d& uvd_px, double half_width_m, double half_height_m) {
    const double px_per_m = uvd_px.z() / kNarrowRig.baseline_m;
    return {std::round(uvd_px.x() - half_width_m * px_per_m), std::round(uvd_px.y() - half_height_m * px_per_m),
            std::round(uvd_px.x() + half_width_m * px_per_m), std::round(uvd_px.y() + half_height_m * px_per_m)};
  }
  Box boardBox() const { return around(onBoard_px(0, 0), board_.width_m / 2, board_.height_m / 2); }

  /// The newest frame, in which a label covers a box, with points as they are measured without error.
  std::shared_ptr<SceneMotion> now(const Box& labelled, const std::vector<Eigen::Vector3d>& points_px) const {
    auto labels = std::make_shared<InstanceLabels>(kNarrowRig.width_px, kNarrowRig.height_px);
    for (int v = static_cast<int>(labelled.top_px); v <= static_cast<int>(labelled.bottom_px); ++v)
      for (int u = static_cast<int>(labelled.left_px); u <= static_cast<int>(labelled.right_px); ++u)
        labels->mutableRow(v)[u] = kLabel;
    return scene(kNow, std::move(labels), points_px);
  }
  /// The newest frame, or one after it, without labels. The points were followed, and not where they would be at rest;
  /// the board stands on the road.
  std::shared_ptr<SceneMotion> withoutLabels(const std::vector<Eigen::Vector3d>& points_px, int frame = kNow) const {
    auto newest = scene(frame, nullptr, points_px);
    for (ScenePoint& point : newest->points) point.age = 2;
    newest->ground.height_m = middle_m(kNow).y() + board_.height_m / 2;
    return newest;
  }
  static InstanceRegion region(const Box& labelled) { return {kLabel, labelled}; }

  LookBack past{12, 3, {}, kNarrowRig};  // with all frames but the newest

 private:
  static constexpr std::uint16_t kLabel = 6;

  static Timestamp stampOf(int frame) {
    return Timestamp{static_cast<std::int64_t>(std::llround(1e9 * kFrame_s)) * frame};
  }
  static Eigen::Vector3d seenNow_px(const Eigen::Vector3d& p_world) {
    return *kNarrowRig.project(T_world_cam().inverse() * p_world);
  }
  Eigen::Vector3d middle_m(int frame) const {
    return {0.4 + board_.walk_mps * kFrame_s * (frame - kNow), 0.1, kBoard_m};
  }
  std::shared_ptr<SceneMotion> scene(int frame, std::shared_ptr<const InstanceLabels> labels,
                                     const std::vector<Eigen::Vector3d>& points_px) const {
    constexpr int kLevels = 3;
    auto pair = std::make_shared<StereoFrame>();
    pair->head = {.frame = {frame}, .stamp = stampOf(frame)};
    pair->left = view(frame, 0), pair->right = view(frame, kNarrowRig.baseline_m);
    pair->inputs.instances = std::move(labels);
    ImagePool pool;
    auto features = std::make_shared<Features>();
    features->frame = pair;
    features->left = buildPyramid(pair->left, kLevels, pool);
    features->right = buildPyramid(pair->right, kLevels, pool);
    auto scene = std::make_shared<SceneMotion>();
    scene->head = pair->head;
    scene->odometry.T_previous_now = T_world_cam(0).inverse() * T_world_cam(1);  // as each step is
    scene->camera_speed_mps = scene->odometry.T_previous_now.translation().norm() / kFrame_s;
    scene->features = features;
    const InstanceLabels* instances = pair->inputs.instances.get();
    for (const Eigen::Vector3d& uvd_px : points_px)
      scene->points.push_back({.point = {std::ssize(scene->points)},
                               .uvd_px = uvd_px,
                               .sigma_px = Eigen::Vector3d::Constant(0.3),
                               .instance = instances ? instances->at(uvd_px.x(), uvd_px.y()) : std::uint16_t{0},
                               .flow = {}});
    return scene;
  }
  Image view(int frame, double aside_m) const {
    constexpr double kNoise_gray = 1.5;
    const SE3 T = T_world_cam(frame);
    const Eigen::Vector3d origin = T * Eigen::Vector3d(aside_m, 0, 0), middle = middle_m(frame);
    const auto gray = [&](double u, double v) {
      const Eigen::Vector3d ray = T.rotation() * Eigen::Vector3d((u - kNarrowRig.cx_px) / kNarrowRig.fx_px,
                                                                 (v - kNarrowRig.cy_px) / kNarrowRig.fy_px, 1);
      const auto at = [&](double z_m) -> Eigen::Vector3d { return origin + (z_m - origin.z()) / ray.z() * ray; };
      const Eigen::Vector3d on_wall = at(kWall_m), on_board = at(kBoard_m) - middle;
      const double px_per_m = kNarrowRig.fx_px / (kBoard_m - origin.z());
      const double share = coverage((board_.width_m / 2 - std::abs(on_board.x())) * px_per_m) *
                           coverage((board_.height_m / 2 - std::abs(on_board.y())) * px_per_m);
      const double wall = share < 1 ? wall_texture_(20 * on_wall.x(), 20 * on_wall.y()) : 0;
      const double board = share > 0 ? board_texture_(50 * on_board.x(), 50 * on_board.y()) : 0;
      return wall + share * (board - wall);
    };
    const unsigned seed = 100 * board_.seed + 2 * frame + (aside_m > 0 ? 1 : 0);
    return render(kNarrowRig.width_px, kNarrowRig.height_px, gray, {.noise = kNoise_gray, .seed = seed});
  }
  /// Share of a pixel that a surface covers if it ends so far from the pixel's middle.
  static double coverage(double inside_px) { return std::clamp(inside_px + 0.5, 0.0, 1.0); }

  Board board_;
  GrainTexture board_texture_, wall_texture_;
};

}  // namespace motorcade::test
