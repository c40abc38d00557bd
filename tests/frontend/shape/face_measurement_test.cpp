#include "frontend/shape/face_measurement.hpp"

#include <gtest/gtest.h>

#include "tests/frontend/shape/street_by_hand.hpp"

namespace motorcade {
namespace {

using test::kRig;
using test::outlineOf;
using test::StreetByHand;

const Eigen::Vector3d kMeasuredCar_m(4.5, 1.75, 1.45);
constexpr PixelWindow kFaceWindow{.u0 = 220, .v0 = 50, .width = 160, .height = 110};

FaceInformation measuredFaces(const LevelDisparities& seen, const Outline& outline, const ObjectView& view) {
  return measureFaces(seen, outline, surfacePoints(seen, outline, view, kRig), view, kRig);
}

/// The estimate after some looks from successive frames, as the stage makes them.
BoxEstimate afterLooks(const SE3& T_cam_body, const SE3& T_cam_frame, const Eigen::Vector3d& size_m) {
  const StreetByHand street({{T_cam_body, StreetByHand::faces(size_m)}});
  const LevelDisparities seen = street.disparities(kFaceWindow, 1);
  FaceInformation evidence;
  ObjectView view{.T_cam_body = T_cam_frame,
                  .box = estimateBox(evidence, {10}),
                  .ground = {.normal_cam = {0, 1, 0}, .height_m = StreetByHand::kRoad_m},
                  .disparity_offset_px = 0};
  for (int i = 0; i < 15; ++i) {
    evidence.add(measuredFaces(seen, outlineOf(seen, view), view), 0.15);
    view.box = estimateBox(evidence, {10});
  }
  return view.box;
}

TEST(FaceMeasurement, FindsTheFacesInViewAndTheRoad) {
  const double yaw_rad = 0.7;
  const SE3 T_cam_body = StreetByHand::standingAt(0, 14, yaw_rad);
  const SE3 T_cam_frame = T_cam_body * SE3(Eigen::Matrix3d::Identity(), {-1.2, 0.3, 0.8});  // on the body, anywhere
  const BoxEstimate box = afterLooks(T_cam_body, T_cam_frame, kMeasuredCar_m);
  const Eigen::Vector3d least = box.least() + Eigen::Vector3d(-1.2, 0.3, 0.8),
                        most = box.most() + Eigen::Vector3d(-1.2, 0.3, 0.8);
  EXPECT_NEAR(least.x(), -0.5 * kMeasuredCar_m.x(), 0.15);
  EXPECT_NEAR(most.x(), 0.5 * kMeasuredCar_m.x(), 0.3);
  EXPECT_NEAR(least.y(), -0.5 * kMeasuredCar_m.y(), 0.15);
  EXPECT_NEAR(least.z(), 0, 0.08);
  EXPECT_NEAR(most.z(), kMeasuredCar_m.z(), 0.12);
  EXPECT_EQ(box.kind, ObjectKind::kCar);
}

TEST(FaceMeasurement, AVehicleSeenFromBehindKeepsTheUsualLength) {
  const SE3 T_cam_body = StreetByHand::standingAt(-0.2, 14);
  const BoxEstimate box =
      afterLooks(T_cam_body, T_cam_body * SE3(Eigen::Matrix3d::Identity(), {-2, 0, 0.8}), kMeasuredCar_m);
  EXPECT_NEAR(box.least().x() - 2, -0.5 * kMeasuredCar_m.x(), 0.15);
  EXPECT_NEAR(box.box().size_m.y(), kMeasuredCar_m.y(), 0.15);
  EXPECT_GT(box.box().size_sigma_m.x(), 3 * box.box().size_sigma_m.y());
}

TEST(FaceMeasurement, HoldsTheFollowedPoints) {
  const SE3 T_cam_body = StreetByHand::standingAt(0, 14);
  const StreetByHand street({{T_cam_body, StreetByHand::faces(kMeasuredCar_m)}});
  const LevelDisparities seen = street.disparities(kFaceWindow, 1);
  ObjectView view{.T_cam_body = T_cam_body, .box = estimateBox({}, {10}), .ground = {}, .disparity_offset_px = 0};
  const auto front = [&] {
    FaceInformation look;
    look.add(
        measuredFaces(seen, {.window = kFaceWindow, .inside = std::vector<std::uint8_t>(kFaceWindow.area(), 0)}, view));
    return estimateBox(look, {10}).most().x();
  };
  const double without = front();
  view.points = Eigen::AlignedBox3d(Eigen::Vector3d(-1, -0.5, 0), Eigen::Vector3d(5, 0.5, 1));
  EXPECT_LT(without, 3);
  EXPECT_GT(front(), 4);
}

/// Points that reach farther than is believed end where the body does only if one sees its flank.
TEST(FaceMeasurement, PointsTellWhereAFlankInViewEnds) {
  const auto look_from = [](double aside_m) {
    const SE3 T_cam_body = StreetByHand::standingAt(aside_m, 14);
    const StreetByHand street({{T_cam_body, StreetByHand::faces(kMeasuredCar_m)}});
    ObjectView view{.T_cam_body = T_cam_body, .box = estimateBox({}, {10}), .ground = {}, .disparity_offset_px = 0};
    view.points = Eigen::AlignedBox3d(Eigen::Vector3d(-1, -2, 0), Eigen::Vector3d(5, 0.5, 1));
    const Outline nothing{.window = kFaceWindow, .inside = std::vector<std::uint8_t>(kFaceWindow.area(), 0)};
    return measuredFaces(street.disparities(kFaceWindow, 1), nothing, view);
  };
  const FaceInformation behind = look_from(0), beside = look_from(-3);
  EXPECT_GT(behind.reach_weight[kFront], 0);
  EXPECT_EQ(behind.H(kFront, kFront), 0);
  EXPECT_EQ(beside.reach_weight[kFront], 0);
  EXPECT_GT(beside.H(kFront, kFront), 0);
  for (const FaceInformation& look : {behind, beside}) EXPECT_GT(look.reach_weight[kRight], 0);
}

TEST(FaceMeasurement, AWrongBeliefOfTheRearGivesWayToTheSideThatIsSeenBehindIt) {
  // A car that overtakes: its side fills the view, and its rear is believed to be two meters ahead of where it is.
  const SE3 T_cam_body = StreetByHand::standingAt(-3.3, 9);
  const StreetByHand street({{T_cam_body, StreetByHand::faces(kMeasuredCar_m)}});
  const LevelDisparities seen = street.disparities({.u0 = 40, .v0 = 60, .width = 110, .height = 60}, 2);
  FaceInformation evidence;
  evidence.add(Vector6d::Unit(kRear), -0.5 * kMeasuredCar_m.x() + 2, 0.2);
  ObjectView view{.T_cam_body = T_cam_body,
                  .box = estimateBox(evidence, {15}),
                  .ground = {.normal_cam = {0, 1, 0}, .height_m = StreetByHand::kRoad_m},
                  .disparity_offset_px = 0};
  EXPECT_GT(view.box.least().x(), -0.5 * kMeasuredCar_m.x() + 1.5);
  for (int i = 0; i < 40; ++i) {
    evidence.add(measuredFaces(seen, outlineOf(seen, view), view), 0.15);
    view.box = estimateBox(evidence, {15});
  }
  EXPECT_NEAR(view.box.least().x(), -0.5 * kMeasuredCar_m.x(), 0.3);
}

TEST(FaceMeasurement, AFlankThatGoesOnWhereItIsNoLongerSharpIsLonger) {
  // A trailer beside us: its rear is out of view, its front twelve meters ahead; distances are sharp up to six.
  const Eigen::Vector3d trailer_m(11, 2.5, 3.2);
  const SE3 T_cam_body = StreetByHand::standingAt(3.5, 6.5);
  const StreetByHand street({{T_cam_body, StreetByHand::faces(trailer_m)}});
  const LevelDisparities seen = street.disparities({.u0 = 80, .v0 = 0, .width = 74, .height = 46}, 3);
  FaceInformation evidence;
  ObjectView view{.T_cam_body = T_cam_body * SE3(Eigen::Matrix3d::Identity(), {-3, 1.25, 1}),
                  .box = estimateBox(evidence, {6}),
                  .ground = {.normal_cam = {0, 1, 0}, .height_m = StreetByHand::kRoad_m},
                  .disparity_offset_px = 0};
  for (int i = 0; i < 15; ++i) {
    evidence.add(measuredFaces(seen, outlineOf(seen, view), view), 0.15);
    view.box = estimateBox(evidence, {6});
  }
  EXPECT_NEAR(view.box.most().x() - 3, 0.5 * trailer_m.x(), 2);
}

}  // namespace
}  // namespace motorcade
