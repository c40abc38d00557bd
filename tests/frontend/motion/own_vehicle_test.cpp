#include "frontend/motion/own_vehicle.hpp"

#include <algorithm>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

const StereoCamera kKittiRig{720, 720, 620, 188, 0.54, 1242, 375};
const StereoCamera kSmallBaselineRig{320, 320, 320, 200, 0.12, 640, 400};
const Eigen::Vector3d kSigma_px = Eigen::Vector3d::Constant(0.2);  // noise of each coordinate
constexpr double kStep_m = 1;                                      // of a camera at 10 m/s, ten frames a second

/// View of a camera on a street, with a part of its own vehicle and another vehicle at its own speed.
class Drive {
 public:
  using Observed = std::vector<std::optional<StereoObservation>>;

  explicit Drive(const StereoCamera& camera, int street_points = 400) : camera_(camera), own_vehicle_(camera) {
    for (int i = 0; i < street_points; ++i) street_.push_back({next_id_++, streetPoint(noise_.uniform(4, 60))});
  }

  /// A grid of points that are fixed to the camera, in a part of the image that is filled by a surface so far ahead.
  void addPart(const Box& box, double z_m, double step_px = 20) {
    for (double v = box.top_px; v <= box.bottom_px; v += step_px)
      for (double u = box.left_px; u <= box.right_px; u += step_px)
        fixed_.push_back({next_id_++, camera_.triangulate({u, v, camera_.fx_px * camera_.baseline_m / z_m})});
  }
  void addBonnet() { addPart({10, 0.84 * camera_.height_px, camera_.width_px - 10.0, camera_.height_px - 10.0}, 2.5); }
  void removeParts() { fixed_.clear(); }
  /// A point that appears here and slides to the left, with the disparity of the sky.
  PointId addReflection(double u_px, double v_px) {
    reflections_.push_back({next_id_, {u_px, v_px, 1}});
    return {next_id_++};
  }

  /// Advances to the next frame, `step_m` farther ahead; returns its remaining observations.
  Observed advance(double step_m) {
    flow_.observations.clear();
    seen_.clear();
    for (auto& [id, p_cam] : street_) {
      p_cam.z() -= step_m;
      if (p_cam.z() < 1) id = next_id_++, p_cam = streetPoint(60);
    }
    for (auto& [id, uvd_px] : reflections_) uvd_px.x() -= 5 * step_m;
    std::ranges::sort(street_, {}, &Point::id);
    std::vector<std::pair<std::int64_t, Eigen::Vector3d>> all;
    for (const auto* points : {&street_, &fixed_})
      for (const Point& point : *points)
        if (const auto uvd_px = camera_.project(point.at)) all.emplace_back(point.id, *uvd_px);
    for (const Point& point : reflections_) all.emplace_back(point.id, point.at);
    std::ranges::sort(all, {}, &std::pair<std::int64_t, Eigen::Vector3d>::first);
    for (const auto& [id, uvd_px] : all)
      if (camera_.inLeftImage(uvd_px.x(), uvd_px.y())) add(id, uvd_px);
    trail_.add({frame_++ * 100'000'000}, SE3(Eigen::Matrix3d::Identity(), {0, 0, step_m}));
    own_vehicle_.learn(flow_, seen_, trail_);
    Observed observed = seen_;
    own_vehicle_.leaveOut(flow_, observed);
    return observed;
  }
  Observed advance(int frames, double step_m) {
    Observed observed;
    for (int i = 0; i < frames; ++i) observed = advance(step_m);
    return observed;
  }

  int leftOf(const std::vector<std::int64_t>& ids, const Observed& observed) const {
    int left = 0;
    for (std::size_t i = 0; i < observed.size(); ++i)
      left += observed[i] && std::ranges::binary_search(ids, flow_.observations[i].point.value);
    return left;
  }
  std::vector<std::int64_t> fixedIds() const { return idsOf(fixed_); }
  std::vector<std::int64_t> streetIds() const { return idsOf(street_); }
  int seen(const std::vector<std::int64_t>& ids) const { return leftOf(ids, seen_); }
  OwnVehicle& ownVehicle() { return own_vehicle_; }

 private:
  struct Point {
    std::int64_t id;
    Eigen::Vector3d at;
  };

  static std::vector<std::int64_t> idsOf(const std::vector<Point>& points) {
    std::vector<std::int64_t> ids;
    for (const Point& point : points) ids.push_back(point.id);
    return ids;
  }
  Eigen::Vector3d streetPoint(double z_m) {
    const bool on_road = noise_.uniform(0, 1) < 0.5;
    return {z_m * noise_.uniform(-0.7, 0.7), on_road ? 1.65 : noise_.uniform(-3, 1.65), z_m};
  }
  void add(std::int64_t id, const Eigen::Vector3d& uvd_px) {
    const Eigen::Vector3f noisy = (uvd_px + noise_.gaussian(kSigma_px)).cast<float>();
    flow_.observations.push_back({{id}, noisy.x(), noisy.y(), 0.25F, 1, -1});
    seen_.push_back(StereoObservation{noisy, Eigen::Vector3f::Constant(0.25F)});
  }

  StereoCamera camera_;
  OwnVehicle own_vehicle_;
  test::Noise noise_{3};
  std::int64_t next_id_ = 0, frame_ = 0;
  std::vector<Point> street_, fixed_, reflections_;
  CameraTrail trail_;
  OpticalFlow flow_;
  Observed seen_;
};

TEST(OwnVehicle, PointsOfABonnetAreLeftOutFromTheirSecondFrameOnAndItsPlaceWithinTwoSeconds) {
  for (const StereoCamera& camera : {kKittiRig, kSmallBaselineRig}) {
    Drive drive(camera);
    drive.addBonnet();
    const auto first = drive.advance(kStep_m);
    EXPECT_GT(drive.leftOf(drive.fixedIds(), first), 50);  // nothing is known yet
    EXPECT_EQ(drive.leftOf(drive.fixedIds(), drive.advance(kStep_m)), 0);
    EXPECT_FALSE(drive.ownVehicle().view());
    const auto later = drive.advance(20, kStep_m);
    EXPECT_EQ(drive.leftOf(drive.fixedIds(), later), 0);
    ASSERT_TRUE(drive.ownVehicle().view());
    EXPECT_NEAR(drive.ownVehicle().view()->share, 0.18, 0.03);  // 0.16 and up to a cell more
    EXPECT_EQ(drive.ownVehicle().view()->box.bottom_px, camera.height_px - 1);
    EXPECT_GT(drive.leftOf(drive.streetIds(), later), 0.8 * drive.seen(drive.streetIds()));
  }
}

TEST(OwnVehicle, NothingIsFoundWhereNothingIsFixedToTheCamera) {
  Drive drive(kKittiRig);
  for (int frame = 0; frame < 60; ++frame) {
    const auto observed = drive.advance(kStep_m);
    EXPECT_EQ(drive.leftOf(drive.streetIds(), observed), drive.seen(drive.streetIds()));
  }
  EXPECT_FALSE(drive.ownVehicle().view());
}

TEST(OwnVehicle, NothingIsKnownWhileTheCameraStandsAndAllSoonAfterItStarts) {
  Drive drive(kKittiRig);
  drive.addBonnet();
  const auto standing = drive.advance(50, 0.0);
  EXPECT_EQ(drive.leftOf(drive.fixedIds(), standing), drive.seen(drive.fixedIds()));
  EXPECT_EQ(drive.leftOf(drive.streetIds(), standing), drive.seen(drive.streetIds()));
  drive.advance(3, kStep_m);
  EXPECT_EQ(drive.leftOf(drive.fixedIds(), drive.advance(kStep_m)), 0);
  drive.advance(20, kStep_m);
  ASSERT_TRUE(drive.ownVehicle().view());
  const double share = drive.ownVehicle().view()->share;
  const auto again = drive.advance(50, 0.0);
  EXPECT_EQ(drive.leftOf(drive.fixedIds(), again), 0);
  EXPECT_EQ(drive.ownVehicle().view()->share, share);
}

/// Vehicles keep our pace exactly, as no real one does.
TEST(OwnVehicle, VehiclesAheadAndBesideAtTheSameSpeedAreNotTheOwn) {
  Drive drive(kKittiRig);
  drive.addPart({400, 150, 800, 370}, 3.8);  // ahead, as near as a vehicle in front of a bonnet may be
  drive.addPart({10, 100, 60, 370}, 2.6);    // 2 m aside and more
  for (int frame = 0; frame < 40; ++frame) {
    const auto observed = drive.advance(kStep_m);
    EXPECT_EQ(drive.leftOf(drive.fixedIds(), observed), drive.seen(drive.fixedIds()));
  }
  EXPECT_FALSE(drive.ownVehicle().view());
}

/// Wrong disparities on vehicles that keep our pace.
TEST(OwnVehicle, AFewPointsAreNotTheOwnVehicle) {
  Drive drive(kKittiRig);
  drive.addPart({600, 350, 640, 350}, 2.5);
  drive.advance(30, kStep_m);
  EXPECT_EQ(drive.leftOf(drive.fixedIds(), drive.advance(kStep_m)), 3);
  EXPECT_FALSE(drive.ownVehicle().view());
}

TEST(OwnVehicle, APartAtTheLeftIsMaskedToTheLeftAndNotBelow) {
  Drive drive(kKittiRig);
  drive.addPart({10, 120, 90, 200}, 1.5);
  drive.advance(30, kStep_m);
  ASSERT_TRUE(drive.ownVehicle().view());
  const Box& box = drive.ownVehicle().view()->box;
  EXPECT_EQ(box.left_px, 0);
  EXPECT_NEAR(box.right_px, 90, 2 * OwnVehicleMap::kCell_px);
  EXPECT_NEAR(box.bottom_px, 200, 2 * OwnVehicleMap::kCell_px);
}

TEST(OwnVehicle, ReflectionsThatSlideOverABonnetAreLeftOut) {
  Drive drive(kKittiRig);
  drive.addPart({10, 310, 1232, 330}, 2.5);  // nothing is seen of its lower part
  drive.advance(30, kStep_m);
  const PointId reflection = drive.addReflection(600, 350);
  for (int frame = 0; frame < 5; ++frame) EXPECT_EQ(drive.leftOf({reflection.value}, drive.advance(kStep_m)), 0);
}

TEST(OwnVehicle, WhatIsSeenThroughLaterIsGivenUp) {
  Drive drive(kKittiRig, 1500);
  drive.addPart({10, 260, 1232, 365}, 2.5);
  drive.advance(30, kStep_m);
  ASSERT_TRUE(drive.ownVehicle().view());
  const double share = drive.ownVehicle().view()->share;
  drive.removeParts();
  drive.advance(900, kStep_m);  // until enough points passed through most cells
  EXPECT_LT(drive.ownVehicle().view() ? drive.ownVehicle().view()->share : 0, 0.5 * share);
}

TEST(OwnVehicle, AfterAMotionThatWasNotMeasuredPointsProveNothing) {
  Drive drive(kKittiRig);
  drive.addBonnet();
  drive.advance(kStep_m);
  drive.ownVehicle().forgetPoints();
  EXPECT_EQ(drive.leftOf(drive.fixedIds(), drive.advance(kStep_m)), drive.seen(drive.fixedIds()));
}

/// The disparities of all points change at once when the rig's offset is learned.
TEST(OwnVehicle, AChangeOfTheDisparityOffsetIsNoMotion) {
  Drive drive(kKittiRig);
  drive.addBonnet();
  drive.advance(2, kStep_m);
  drive.ownVehicle().shiftDisparities(5);
  EXPECT_GT(drive.leftOf(drive.fixedIds(), drive.advance(kStep_m)), 50);  // as the drive's disparities stay
}

}  // namespace
}  // namespace motorcade
