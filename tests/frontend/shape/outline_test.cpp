#include "frontend/shape/outline.hpp"

#include <gtest/gtest.h>

#include "frontend/shape/outline_completion.hpp"
#include "tests/frontend/shape/street_by_hand.hpp"
#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

using test::kRig;
using test::outlineOf;
using test::StreetByHand;

const Eigen::Vector3d kOutlinedCar_m(4.2, 1.8, 1.5);
constexpr PixelWindow kOutlineWindow{.u0 = 230, .v0 = 60, .width = 140, .height = 100};

ObjectView viewOf(const SE3& T_cam_body, const Eigen::Vector3d& size_m) {
  FaceInformation sure;
  for (int face = 0; face < 6; ++face) sure.add(Vector6d::Unit(face), StreetByHand::faces(size_m)[face], 0.1);
  return {.T_cam_body = T_cam_body,
          .box = estimateBox(sure, {10}),
          .ground = {.normal_cam = {0, 1, 0}, .height_m = StreetByHand::kRoad_m},
          .disparity_offset_px = 0};
}

struct Overlap {
  int both = 0, either = 0, outside = 0;
  double iou() const { return static_cast<double>(both) / either; }
};
Overlap overlapOf(const Outline& outline, const LevelDisparities& seen, const StreetByHand& street, int item) {
  Overlap overlap;
  for (int row = 0; row < outline.window.height; ++row)
    for (int column = 0; column < outline.window.width; ++column) {
      const bool truth = street.at(seen.u_px(column), seen.v_px(row)).item == item, found = outline.at(column, row);
      overlap.both += truth && found;
      overlap.either += truth || found;
      overlap.outside += !truth && found;
    }
  return overlap;
}

class OutlineAtYaw : public testing::TestWithParam<double> {};

TEST_P(OutlineAtYaw, CoversTheCarAndNotTheRoad) {
  const SE3 T_cam_body = StreetByHand::standingAt(-0.3, 13, GetParam());
  const StreetByHand street({{T_cam_body, StreetByHand::faces(kOutlinedCar_m)}});
  const LevelDisparities seen = street.disparities(kOutlineWindow, 1);
  const ObjectView view = viewOf(T_cam_body, kOutlinedCar_m);
  Outline outline = outlineOf(seen, view);
  const double before = overlapOf(outline, seen, street, 0).iou();
  completeOutline(outline, seen, view, kRig);
  const Overlap overlap = overlapOf(outline, seen, street, 0);
  EXPECT_GT(overlap.iou(), before);
  EXPECT_GT(overlap.iou(), 0.85);
  EXPECT_LT(overlap.outside, 0.05 * overlap.either);
}

INSTANTIATE_TEST_SUITE_P(Yaws, OutlineAtYaw, testing::Values(0.0, 0.6, 1.5));

/// The outline and the wheels of what stands before the camera.
struct Completed {
  StreetByHand street;
  LevelDisparities seen;
  Outline outline;

  Completed(const Eigen::Vector3d& size_m, double z_m)
      : street({{StreetByHand::standingAt(0, z_m), StreetByHand::faces(size_m)}}),
        seen(street.disparities(kOutlineWindow, 1)) {
    const ObjectView view = viewOf(StreetByHand::standingAt(0, z_m), size_m);
    outline = outlineOf(seen, view);
    completeOutline(outline, seen, view, kRig);
  }
};

TEST(OutlineCompletion, OneSeesTheRoadBetweenTheWheels) {
  const Completed car(kOutlinedCar_m, 13);
  const double rear_m = 13 - kOutlinedCar_m.x() / 2 + 0.45;  // to where the rear wheels stand
  const auto isInside = [&](double x_m, double height_m) {
    const double u = kRig.cx_px + kRig.fx_px * x_m / rear_m,
                 v = kRig.cy_px + kRig.fy_px * (StreetByHand::kRoad_m - height_m) / rear_m;
    return car.outline.at(static_cast<int>(u / 2) - kOutlineWindow.u0, static_cast<int>(v / 2) - kOutlineWindow.v0);
  };
  for (const double x_m : {-0.8, 0.8}) EXPECT_TRUE(isInside(x_m, 0.02));
  EXPECT_FALSE(isInside(0, 0.02));
  EXPECT_TRUE(isInside(0, 0.5));
}

TEST(OutlineCompletion, APersonStandsOnTheRoad) {
  const Completed person({0.6, 0.7, 1.75}, 9);
  EXPECT_GT(overlapOf(person.outline, person.seen, person.street, 0).iou(), 0.85);
}

TEST(Outline, LeavesOthersAlone) {
  const SE3 T_near = StreetByHand::standingAt(-0.6, 12), T_far = StreetByHand::standingAt(1.6, 13);
  const StreetByHand street(
      {{T_near, StreetByHand::faces(kOutlinedCar_m)}, {T_far, StreetByHand::faces(kOutlinedCar_m)}});
  const LevelDisparities seen = street.disparities(kOutlineWindow, 1);
  ObjectView view = viewOf(T_near, kOutlinedCar_m);
  view.box.usual_most += Eigen::Vector3d(0, 0.5, 0), view.box.possible_most = view.box.usual_most;
  view.box.usual_least -= Eigen::Vector3d(0, 2.5, 0), view.box.possible_least = view.box.usual_least;  // over the other
  const auto taken = [&] {
    const Outline outline = outlineOf(seen, view);
    return overlapOf(outline, seen, street, 1).both;
  };
  const int without = taken();
  const BoxFaces faces = StreetByHand::faces(kOutlinedCar_m);
  view.others.push_back({T_far.inverse(), Eigen::Vector3d(faces[0], faces[2], faces[4]).array() - 0.2,
                         Eigen::Vector3d(faces[1], faces[3], faces[5]).array() + 0.2});
  EXPECT_GT(without, 100);
  EXPECT_LT(taken(), 0.1 * without);
}

/// A second car beside the first, in the volume that is thought possible: one moved aside since the frame before, the
/// other rests.
TEST(Outline, LeavesOutWhatRests) {
  constexpr int kLevel = 1;
  const SE3 T_now = StreetByHand::standingAt(-0.6, 12), T_before = StreetByHand::standingAt(-1.0, 12),
            T_parked = StreetByHand::standingAt(1.6, 12);
  const StreetByHand now(
      {{T_now, StreetByHand::faces(kOutlinedCar_m)}, {T_parked, StreetByHand::faces(kOutlinedCar_m)}}),
      before({{T_before, StreetByHand::faces(kOutlinedCar_m)}, {T_parked, StreetByHand::faces(kOutlinedCar_m)}});
  const test::Texture texture(3);
  const auto pyramid = [&](const StreetByHand& street, double moved_px) {
    ImagePyramid images;
    for (int level = 0; level <= kLevel; ++level)  // the coarser level alone is looked at
      images.levels.push_back(test::render(kRig.width_px >> level, kRig.height_px >> level, [&](double u, double v) {
        const double scale = 1 << level, full_u = (u + 0.5) * scale - 0.5, full_v = (v + 0.5) * scale - 0.5;
        return texture(u - (street.at(full_u, full_v).item == 0 ? moved_px : 0), v);
      }));
    return images;
  };
  const ImagePyramid images_now = pyramid(now, 0),
                     images_before = pyramid(before, -kRig.fx_px * 0.4 / (12 - kOutlinedCar_m.x() / 2) / (1 << kLevel));
  const LevelDisparities seen = now.disparities(kOutlineWindow, kLevel);
  ObjectView view = viewOf(T_now, kOutlinedCar_m);
  view.box.usual_least -= Eigen::Vector3d(0, 3.2, 0), view.box.possible_least = view.box.usual_least;
  const Outline without = outlineOf(seen, view);
  view.before = {&images_now, &images_before, T_before, SE3{}};
  const Outline with = outlineOf(seen, view);
  EXPECT_GT(overlapOf(without, seen, now, 1).both, 300);
  EXPECT_LT(overlapOf(with, seen, now, 1).both, 0.3 * overlapOf(without, seen, now, 1).both);
  EXPECT_GT(overlapOf(with, seen, now, 0).both, 0.8 * overlapOf(without, seen, now, 0).both);
}

TEST(Outline, FillsWhatGivesNoDisparity) {
  const SE3 T_cam_body = StreetByHand::standingAt(0, 12);
  const StreetByHand street({{T_cam_body, StreetByHand::faces(kOutlinedCar_m)}});
  LevelDisparities seen = street.disparities(kOutlineWindow, 1);
  const ObjectView view = viewOf(T_cam_body, kOutlinedCar_m);
  const Outline whole = outlineOf(seen, view);
  const PixelWindow bounds = whole.bounds();
  for (int row = bounds.v0 + 5; row < bounds.v0 + bounds.height - 5; ++row)  // its windows
    for (int column = bounds.u0 + 8; column < bounds.u0 + bounds.width - 8; ++column)
      seen.map.disparity_px[static_cast<std::size_t>(row) * kOutlineWindow.width + column] = DisparityMap::kNone;
  EXPECT_GT(outlineOf(seen, view).count(), 0.95 * whole.count());
}

TEST(Outline, BoxInTheImageHoldsTheCorners) {
  const SE3 T_cam_body = StreetByHand::standingAt(0, 12);
  const auto box = projectedBox({-2.1, -0.9, 0}, {2.1, 0.9, 1.5}, T_cam_body, kRig);
  ASSERT_TRUE(box);
  EXPECT_NEAR(box->right_px - box->left_px, kRig.fx_px * 1.8 / 9.9, 1e-6);  // the rear face is at 9.9 m
  EXPECT_NEAR(box->bottom_px, kRig.cy_px + kRig.fy_px * 1.65 / 9.9, 1e-6);
  EXPECT_FALSE(projectedBox({-2.1, -0.9, 0}, {2.1, 0.9, 1.5}, StreetByHand::standingAt(40, 12), kRig));
}

}  // namespace
}  // namespace motorcade
