#pragma once

#include <memory>
#include <vector>

#include "tests/frontend/texture.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade::test {

/// A rig of few pixels, so that its images are quickly rendered.
inline constexpr StereoCamera kSmallRig{
    .fx_px = 300, .fy_px = 300, .cx_px = 200, .cy_px = 100, .baseline_m = 0.54, .width_px = 400, .height_px = 200};

/// Two surfaces that face a camera which drives ahead at 10 m/s: one at rest and, at the left, one of a vehicle. Stereo
/// matching and optical flow find them without error.
class TwoSurfaces {
 public:
  static constexpr double kCameraStep_m = 1, kWall_m = 30, kCar_m = 4;
  static constexpr int kWallPoints = 150, kCarPoints = 12;
  /// The car is `car_m` ahead at first.
  explicit TwoSurfaces(double car_step_m, double car_m = kCar_m) : car_step_m_(car_step_m), car_m_(car_m) {}

  /// The disparity of each corner; corner and point have the same number.
  StereoMatchesPtr stereo(int frame, const FrameInputs& inputs = {}) const {
    auto features = std::make_shared<Features>();
    auto pair = std::make_shared<StereoFrame>();
    pair->head = {.frame = {frame}, .stamp = {frame * 100'000'000}};
    pair->inputs = inputs;
    features->frame = pair;
    features->left.levels.push_back(image(frame, 0));
    features->right.levels.push_back(image(frame, kSmallRig.baseline_m));
    auto matches = std::make_shared<StereoMatches>();
    for (int i = 0; i < kWallPoints + kCarPoints; ++i) {
      const Eigen::Vector3f uvd = uvd_px({i}, frame).cast<float>();
      features->corners.push_back({uvd.x(), uvd.y(), 1});
      matches->of_corner.emplace_back(StereoMatch{uvd.z(), 0.2F});
    }
    matches->features = features;
    return matches;
  }
  OpticalFlowPtr flow(const StereoMatches& matches, int frame) const {
    auto flow = std::make_shared<OpticalFlow>();
    flow->features = matches.features;
    for (int i = 0; i < kWallPoints + kCarPoints; ++i) {
      const Eigen::Vector3f uvd = uvd_px({i}, frame).cast<float>();
      flow->observations.push_back({{i}, uvd.x(), uvd.y(), 0.2F, frame + 1, frame == 0 ? i : -1});
    }
    return flow;
  }
  static bool onCar(PointId point) { return point.value >= kWallPoints; }
  Eigen::Vector3d p_cam(PointId point, int frame) const {
    return {points_[point.value].x(), points_[point.value].y(), depth_m(onCar(point), frame)};
  }
  Eigen::Vector3d uvd_px(PointId point, int frame) const { return *kSmallRig.project(p_cam(point, frame)); }

 private:
  double depth_m(bool car, int frame) const {
    return car ? car_m_ + frame * (car_step_m_ - kCameraStep_m) : kWall_m - frame * kCameraStep_m;
  }
  Image image(int frame, double aside_m) const {
    return render(kSmallRig.width_px, kSmallRig.height_px,
                  [&](double u, double v) { return grayAt(u, v, frame, aside_m); });
  }
  /// The car covers x from -1.6 to -0.6 m and y from -0.6 to 0.4 m.
  double grayAt(double u, double v, int frame, double aside_m) const {
    const auto at = [&](double z_m) {
      return Eigen::Vector2d((u - kSmallRig.cx_px) * z_m / kSmallRig.fx_px + aside_m,
                             (v - kSmallRig.cy_px) * z_m / kSmallRig.fy_px);
    };
    const Eigen::Vector2d on_car = at(depth_m(true, frame)), on_wall = at(depth_m(false, frame));
    const bool car = on_car.x() > -1.6 && on_car.x() < -0.6 && on_car.y() > -0.6 && on_car.y() < 0.4;
    return car ? car_texture_(60 * on_car.x(), 60 * on_car.y()) : wall_texture_(12 * on_wall.x(), 12 * on_wall.y());
  }
  static std::vector<Eigen::Vector2d> choosePoints() {
    Noise noise(5);
    std::vector<Eigen::Vector2d> points;
    const auto add = [&](double least_x, double most_x, double least_y, double most_y) {
      const double y = noise.uniform(least_y, most_y), x = noise.uniform(least_x, most_x);
      points.emplace_back(x, y);
    };
    for (int i = 0; i < kWallPoints; ++i) add(-1, 14, -4, 4);
    for (int i = 0; i < kCarPoints; ++i) add(-1.4, -0.8, -0.4, 0.3);
    return points;
  }

  double car_step_m_, car_m_;
  Texture car_texture_{1}, wall_texture_{2};
  std::vector<Eigen::Vector2d> points_ = choosePoints();
};

}  // namespace motorcade::test
