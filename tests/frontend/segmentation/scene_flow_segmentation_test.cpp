#include "frontend/segmentation/scene_flow_segmentation.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/frontend/texture.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

/// Messages of a frame without a single point.
SceneMotionPtr runEmpty(SceneFlowSegmentation& estimate, int frame, const std::string& problem) {
  auto pair = std::make_shared<StereoFrame>();
  pair->frame = {frame};
  pair->stamp = {frame * 100'000'000};
  pair->problem = problem;
  auto features = std::make_shared<Features>();
  features->frame = pair;
  auto stereo = std::make_shared<StereoMatches>();
  stereo->features = features;
  auto flow = std::make_shared<OpticalFlow>();
  flow->features = features;
  return estimate(stereo, flow);
}

TEST(SceneFlowSegmentation, EveryInputGivesOneOutputOfItsFrameAlsoWhenRejectedOrEmpty) {
  SceneFlowSegmentation estimate({}, test::kRig);
  for (int frame = 0; frame < 6; ++frame) {
    const bool rejected = frame == 2 || frame == 3;
    const auto motion = runEmpty(estimate, frame, rejected ? "unreadable" : "");
    ASSERT_TRUE(motion);
    EXPECT_EQ(motion->frame, FrameId{frame});
    EXPECT_EQ(motion->stamp, Timestamp{frame * 100'000'000});
    EXPECT_EQ(motion->status, rejected ? FrameStatus::kRejected : frame == 0 ? FrameStatus::kGood : FrameStatus::kLost);
    EXPECT_TRUE(motion->points.empty());
    EXPECT_THAT(motion->T_previous_now,
                test::IsNearPose(SE3{}, 0.0));  // no motion was ever seen: standing still is predicted
  }
}

TEST(SceneFlowSegmentation, APredictedMotionIsAsWideAsItsParametersSay) {
  const SceneFlowSegmentation::Params params;
  SceneFlowSegmentation estimate(params, test::kRig);
  runEmpty(estimate, 0, "");
  for (const int frame : {1, 2}) {
    const auto motion = runEmpty(estimate, frame, frame == 1 ? "" : "unreadable");
    EXPECT_DOUBLE_EQ(motion->odometry_covariance(0, 0), params.lost_sigma_m * params.lost_sigma_m);
    EXPECT_DOUBLE_EQ(motion->odometry_covariance(4, 4), params.lost_sigma_rad * params.lost_sigma_rad);
  }
}

/// Few pixels, so that its images are quickly rendered.
constexpr StereoCamera kSmallRig{
    .fx_px = 300, .fy_px = 300, .cx_px = 200, .cy_px = 100, .baseline_m = 0.54, .width_px = 400, .height_px = 200};

/// Two surfaces that face the camera, one at rest and one of a vehicle at the left, as a camera sees them that drives
/// ahead.
class TwoSurfaces {
 public:
  static constexpr double kCameraStep_m = 1, kWall_m = 30, kCar_m = 4;
  explicit TwoSurfaces(double car_step_m) : car_step_m_(car_step_m) {}

  SceneMotionPtr see(SceneFlowSegmentation& estimate, int frame) const {
    auto features = std::make_shared<Features>();
    auto pair = std::make_shared<StereoFrame>();
    pair->frame = {frame};
    pair->stamp = {frame * 100'000'000};
    features->frame = pair;
    for (const double eye_m : {0.0, kSmallRig.baseline_m}) {
      const auto gray = [&](double u, double v) { return grayAt(u, v, frame, eye_m); };
      (eye_m > 0 ? features->right : features->left)
          .levels.push_back(test::render(kSmallRig.width_px, kSmallRig.height_px, gray));
    }
    auto stereo = std::make_shared<StereoMatches>();
    auto flow = std::make_shared<OpticalFlow>();
    stereo->features = flow->features = features;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Eigen::Vector3d uvd = *kSmallRig.project(inCamera(i, frame));
      const int corner = frame == 0 ? static_cast<int>(i) : -1;
      flow->observations.push_back({{static_cast<std::int64_t>(i)},
                                    static_cast<float>(uvd.x()),
                                    static_cast<float>(uvd.y()),
                                    0.2F,
                                    frame + 1,
                                    corner});
      features->corners.push_back({static_cast<float>(uvd.x()), static_cast<float>(uvd.y()), 1});
      stereo->of_corner.push_back(StereoMatch{static_cast<float>(uvd.z()), 0.2F});
    }
    return estimate(stereo, flow);
  }
  bool onCar(PointId point) const { return point.value >= kWallPoints; }
  double disparity_px(PointId point, int frame) const {
    return kSmallRig.project(inCamera(static_cast<std::size_t>(point.value), frame))->z();
  }

 private:
  static constexpr int kWallPoints = 150, kCarPoints = 12;

  double depth_m(bool car, int frame) const {
    return car ? kCar_m + frame * (car_step_m_ - kCameraStep_m) : kWall_m - frame * kCameraStep_m;
  }
  /// The car covers x from -1.6 to -0.6 m and y from -0.6 to 0.4 m.
  double grayAt(double u, double v, int frame, double eye_m) const {
    const auto at = [&](double z_m) {
      return Eigen::Vector2d((u - kSmallRig.cx_px) * z_m / kSmallRig.fx_px + eye_m,
                             (v - kSmallRig.cy_px) * z_m / kSmallRig.fy_px);
    };
    const Eigen::Vector2d on_car = at(depth_m(true, frame)), on_wall = at(depth_m(false, frame));
    const bool car = on_car.x() > -1.6 && on_car.x() < -0.6 && on_car.y() > -0.6 && on_car.y() < 0.4;
    return car ? car_texture_(60 * on_car.x(), 60 * on_car.y()) : wall_texture_(12 * on_wall.x(), 12 * on_wall.y());
  }
  Eigen::Vector3d inCamera(std::size_t i, int frame) const {
    return {points_[i].x(), points_[i].y(), depth_m(static_cast<int>(i) >= kWallPoints, frame)};
  }
  static std::vector<Eigen::Vector2d> choosePoints() {
    test::Noise noise(5);
    std::vector<Eigen::Vector2d> points;
    for (int i = 0; i < kWallPoints; ++i) points.emplace_back(noise.uniform(-1, 14), noise.uniform(-4, 4));
    for (int i = 0; i < kCarPoints; ++i) points.emplace_back(noise.uniform(-1.4, -0.8), noise.uniform(-0.4, 0.2));
    return points;
  }

  double car_step_m_;
  test::Texture car_texture_{1}, wall_texture_{2};
  std::vector<Eigen::Vector2d> points_ = choosePoints();
};

/// Beside a camera at 10 m/s: cars that overtake it at 20 m/s and fall back at 5 m/s.
TEST(SceneFlowSegmentation, FindsTheDisparityOfANearVehicleWhateverItsSpeed) {
  for (const double car_step_m : {2.0, 0.5}) {
    const TwoSurfaces scene(car_step_m);
    SceneFlowSegmentation estimate({}, kSmallRig);
    for (int frame = 0; frame < 3; ++frame) {
      const auto motion = scene.see(estimate, frame);
      ASSERT_EQ(motion->status, FrameStatus::kGood);
      int found = 0;
      for (const ScenePoint& p : motion->points)
        found += scene.onCar(p.point) && std::abs(p.uvd_px.z() - scene.disparity_px(p.point, frame)) < 0.5;
      EXPECT_GE(found, 10) << "car moves " << car_step_m << " m, frame " << frame;
    }
  }
}

}  // namespace
}  // namespace motorcade
