#include "frontend/shape/object_shapes.hpp"

#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>

#include <gtest/gtest.h>

#include "frontend/image/image_pyramid.hpp"
#include "tests/frontend/shape/street_by_hand.hpp"
#include "tests/frontend/texture.hpp"

namespace motorcade {
namespace {

using test::kRig;
using test::StreetByHand;

const Eigen::Vector3d kCar_m(4.2, 1.8, 1.5);
constexpr TrackId kTrack{3};
/// The body's origin on the car, as the middle of the points that were followed first may lie.
const Eigen::Vector3d kOrigin_m(0.6, -0.5, 0.7);

/// Random gray levels at the points of a grid, and in between smoothly.
double noiseAt(const Eigen::Vector3d& p_m, double grid_m) {
  const auto random = [](std::int64_t x, std::int64_t y, std::int64_t z) {
    auto bits = static_cast<std::uint64_t>(x * 73'856'093 ^ y * 19'349'663 ^ z * 83'492'791);
    bits = (bits ^ bits >> 30) * 0xBF58476D1CE4E5B9ULL;
    return static_cast<double>((bits ^ bits >> 27) % 160);
  };
  const Eigen::Vector3d at = p_m / grid_m, low = at.array().floor(), share = at - low;
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    Eigen::Vector3d node = low;
    for (int axis = 0; axis < 3; ++axis) {
      const bool upper = corner >> axis & 1;
      weight *= upper ? share[axis] : 1 - share[axis];
      node[axis] += upper ? 1 : 0;
    }
    sum += weight * random(std::llround(node.x()), std::llround(node.y()), std::llround(node.z()));
  }
  return 50 + sum;
}

/// View of a camera at rest on a street with a car, or an empty one; nothing in the dark.
class Scene {
 public:
  explicit Scene(const std::optional<SE3>& T_cam_car, bool dark = false) : T_cam_car_(T_cam_car), dark_(dark) {}

  FeaturesPtr features(FrameId frame) const {
    auto pair = std::make_shared<StereoFrame>();
    pair->head.frame = frame;
    auto features = std::make_shared<Features>();
    features->frame = pair;
    ImagePool pool;
    features->left = buildPyramid(seenFrom(0), 3, pool);
    features->right = buildPyramid(seenFrom(kRig.baseline_m), 3, pool);
    return features;
  }
  /// Share of the union of mask and car that both cover.
  double iou(const ObjectMask& mask) const {
    const StreetByHand street = streetFrom(0);
    int both = 0, either = 0;
    for (int v = 0; v < kRig.height_px; ++v)
      for (int u = 0; u < kRig.width_px; ++u) {
        const int column = (u - mask.left_px) / mask.cell_px, row = (v - mask.top_px) / mask.cell_px;
        const bool inside = u >= mask.left_px && v >= mask.top_px && column < mask.width && row < mask.height;
        const bool found = inside && mask.inside[static_cast<std::size_t>(row) * mask.width + column];
        const bool truth = street.at(u, v).item == 0;
        both += found && truth, either += found || truth;
      }
    return static_cast<double>(both) / either;
  }

 private:
  StreetByHand streetFrom(double x_m) const {
    if (!T_cam_car_) return StreetByHand({});
    return StreetByHand({{SE3(Eigen::Matrix3d::Identity(), {-x_m, 0, 0}) * *T_cam_car_, StreetByHand::faces(kCar_m)}});
  }
  Image seenFrom(double x_m) const {
    const StreetByHand street = streetFrom(x_m);
    return test::render(kRig.width_px, kRig.height_px, [&](double u, double v) {
      if (dark_) return 20.0;
      const StreetByHand::Hit hit = street.at(u, v);
      const Eigen::Vector3d ray((u - kRig.cx_px) / kRig.fx_px, (v - kRig.cy_px) / kRig.fy_px, 1);
      const Eigen::Vector3d p = hit.depth_m * ray + Eigen::Vector3d(x_m, 0, 0);
      return hit.item == 0 ? noiseAt(T_cam_car_->inverse() * p, 0.12) : noiseAt(p, 0.008 * hit.depth_m + 0.05);
    });
  }

  std::optional<SE3> T_cam_car_;
  bool dark_;
};

/// A car that crosses before a camera at rest, to the right; to the left at a negative speed.
class Crossing {
 public:
  static constexpr double kFrame_s = 0.1, kDepth_m = 13;

  explicit Crossing(double first_x_m, double speed_mps = 8, const ObjectShapes::Params& params = {.min_existence = 0})
      : first_x_m_(first_x_m), speed_mps_(speed_mps), shapes_(params, kRig) {}

  SE3 T_cam_car(int frame) const {
    return StreetByHand::standingAt(first_x_m_ + speed_mps_ * kFrame_s * frame, kDepth_m,
                                    speed_mps_ > 0 ? -M_PI / 2 : M_PI / 2);
  }
  /// Estimate of the next frame, with the car, or nothing, where `scene` says.
  FrameEstimate look(ObjectState state, const Scene& scene) {
    const FrameId frame{next_++};
    const SE3 T_cam_body = T_cam_car(static_cast<int>(frame.value)) * shifted(kOrigin_m);
    auto motion = std::make_shared<SceneMotion>();
    motion->head.frame = frame;
    motion->ground = {.normal_cam = {0, 1, 0}, .height_m = StreetByHand::kRoad_m};
    auto measurements = std::make_shared<FrameMeasurements>();
    measurements->head.frame = frame;
    if (state != ObjectState::kPredicted) {
      measurements->objects.push_back(observation(frame, T_cam_body, speed_mps_ > 0 ? -1 : 1));
      measurements->objects.back().born_slow = born_slow;
      if (pointless) measurements->objects.back().measured.clear();
    }
    auto estimates = std::make_shared<Estimates>();
    ObjectEstimate object;
    object.track = kTrack, object.state = state;
    object.T_world_body = T_cam_body;
    object.velocity_world_mps = {speed_mps_, 0, 0};
    object.points = state == ObjectState::kPredicted ? 0 : 20;
    estimates->online.head.frame = frame;
    estimates->online.objects.push_back(object);
    finals_.push_back(estimates->online);
    shaped_ = shapes_({scene.features(frame), motion, measurements}, estimates);
    return shaped_->online;
  }
  FrameEstimate look(ObjectState state) { return look(state, Scene(T_cam_car(next_))); }
  bool born_slow = false, pointless = false;
  const std::vector<ObjectMask>& masks() const { return shaped_->masks; }
  /// Final estimates, with body frames at `T_online_final` in the online ones.
  std::vector<FrameEstimate> finish(const SE3& T_online_final = {}) {
    for (FrameEstimate& final : finals_) {
      SE3& T_world_body = final.objects[0].T_world_body;
      T_world_body = T_world_body * T_online_final;
    }
    return shapes_.finish(finals_);
  }

 private:
  /// Points on the side that is seen.
  static ObjectObservation observation(FrameId frame, const SE3& T_cam_body, int side) {
    ObjectObservation seen;
    seen.track = kTrack, seen.frame = frame;
    seen.T_cam_body = T_cam_body;
    seen.box = {1e9, 1e9, -1e9, -1e9};
    for (const double x : {-1.2, -0.6, 0.0, 0.6, 1.2})
      for (const double z : {0.4, 0.7, 1.0}) {
        const Eigen::Vector3d p_car(x, side * kCar_m.y() / 2, z);
        const auto uvd_px = kRig.project(T_cam_body * (p_car - kOrigin_m));
        if (!uvd_px || !kRig.inLeftImage(uvd_px->x(), uvd_px->y())) continue;
        PointMeasurement point;
        point.uvd_px = uvd_px->cast<float>();
        point.sigma_px.setConstant(0.3F);
        seen.measured.push_back(point);
        seen.box.left_px = std::min(seen.box.left_px, uvd_px->x());
        seen.box.right_px = std::max(seen.box.right_px, uvd_px->x());
      }
    seen.points = static_cast<int>(seen.measured.size());
    return seen;
  }

  static SE3 shifted(const Eigen::Vector3d& by_m) { return {Eigen::Matrix3d::Identity(), by_m}; }

  double first_x_m_, speed_mps_;
  int next_ = 0;
  ObjectShapes shapes_;
  EstimatesPtr shaped_;
  std::vector<FrameEstimate> finals_;
};

/// Expects the cuboid to be that of the car.
void expectTheCar(const ObjectEstimate& object, double tolerance_m, const Eigen::Vector3d& origin_m = kOrigin_m) {
  ASSERT_TRUE(object.cuboid);
  EXPECT_NEAR(object.cuboid->size_m.x(), kCar_m.x(), tolerance_m);
  EXPECT_NEAR(object.cuboid->size_m.z(), kCar_m.z(), tolerance_m);
  const Eigen::Vector3d middle = object.cuboid->center_body + origin_m;
  EXPECT_NEAR(middle.x(), 0, tolerance_m);
  EXPECT_NEAR(middle.y(), 0, tolerance_m);
  EXPECT_NEAR(middle.z(), kCar_m.z() / 2, tolerance_m);
}

TEST(ObjectShapes, FindTheCuboidAndTheMask) {
  Crossing crossing(-3);
  FrameEstimate online;
  for (int frame = 0; frame < 8; ++frame) online = crossing.look(ObjectState::kMoving);
  expectTheCar(online.objects[0], 0.3);
  EXPECT_EQ(online.objects[0].cuboid->kind, ObjectKind::kCar);
  ASSERT_EQ(crossing.masks().size(), 1U);
  EXPECT_GT(Scene(crossing.T_cam_car(7)).iou(crossing.masks()[0]), 0.85);
  for (const FrameEstimate& final : crossing.finish()) expectTheCar(final.objects[0], 0.3);
}

TEST(ObjectShapes, FinalCuboidsStandWhereTheImagesShowedThem) {
  const Eigen::Vector3d shift_m(0.5, 0.3, 0);
  Crossing crossing(-3);
  for (int frame = 0; frame < 5; ++frame) crossing.look(ObjectState::kMoving);
  const Eigen::Vector3d moved_m = kOrigin_m + shift_m;
  for (const FrameEstimate& final : crossing.finish({Eigen::Matrix3d::Identity(), shift_m}))
    expectTheCar(final.objects[0], 0.3, moved_m);
}

TEST(ObjectShapes, FinalCuboidsStandThereWhereTheAxesHaveTurned) {
  const SE3 T_online_final(expSO3({0, 0, 0.6}), Eigen::Vector3d::Zero());
  Crossing crossing(-3);
  for (int frame = 0; frame < 5; ++frame) crossing.look(ObjectState::kMoving);
  for (const FrameEstimate& final : crossing.finish(T_online_final)) {
    ASSERT_TRUE(final.objects[0].cuboid);
    const Eigen::Vector3d middle = T_online_final * final.objects[0].cuboid->center_body + kOrigin_m;
    EXPECT_LT(middle.head<2>().norm(), 0.3) << "frame " << final.head.frame.value;
  }
}

TEST(ObjectShapes, WhatIsHardlySeenStandsBehindItsPoints) {
  Crossing crossing(-1);
  const FrameEstimate online = crossing.look(ObjectState::kMoving, Scene(std::nullopt, true));
  ASSERT_TRUE(online.objects[0].cuboid);
  const ObjectBox& cuboid = *online.objects[0].cuboid;
  EXPECT_NEAR(cuboid.center_body.y() - cuboid.size_m.y() / 2, -kCar_m.y() / 2 - kOrigin_m.y(), 0.2);
}

TEST(ObjectShapes, TheCuboidOfAWalkerWithoutPointsStaysNearItsOrigin) {
  constexpr double kCarAside_m = 1.7, kCarBehind_m = 0.9;
  Crossing walker(-0.5, 1.4);
  walker.pointless = true;
  FrameEstimate online;
  for (int frame = 0; frame < 5; ++frame) {
    const Eigen::Vector3d at = walker.T_cam_car(frame).translation();
    online = walker.look(ObjectState::kMoving,
                         Scene(StreetByHand::standingAt(at.x() - kCarAside_m, at.z() + kCarBehind_m, M_PI / 2)));
  }
  ASSERT_TRUE(online.objects[0].cuboid);
  const ObjectBox& cuboid = *online.objects[0].cuboid;
  const Eigen::Array2d beside_m = cuboid.center_body.head<2>().array().abs() - cuboid.size_m.head<2>().array() / 2;
  EXPECT_LT(beside_m.max(0).matrix().norm(), 0.48);  // 0.51 where only the outline counts, which is the car's
}

TEST(ObjectShapes, WhatLeavesTheImageKeepsItsCuboid) {
  for (const double side : {-1.0, 1.0}) {
    Crossing crossing(5 * side, 8 * side);
    FrameEstimate online;
    for (int frame = 0; frame < 8; ++frame) online = crossing.look(ObjectState::kMoving);
    const double u_px = kRig.project(crossing.T_cam_car(7).translation())->x();
    ASSERT_TRUE(u_px < 120 || u_px > kRig.width_px - 120);  // half of it is beyond the border
    expectTheCar(online.objects[0], 0.6);
  }
}

TEST(ObjectShapes, AnOutlineThatMovesAsPredictedIsSeen) {
  Crossing crossing(-3);
  for (int frame = 0; frame < 4; ++frame) crossing.look(ObjectState::kMoving);
  const FrameEstimate online = crossing.look(ObjectState::kPredicted);
  EXPECT_EQ(online.objects[0].state, ObjectState::kMoving);
  EXPECT_GT(online.objects[0].points, 100);
  EXPECT_EQ(crossing.masks().size(), 1U);
  const FrameEstimate final = crossing.finish()[4];
  EXPECT_EQ(final.objects[0].state, ObjectState::kMoving);
  EXPECT_EQ(final.objects[0].points, online.objects[0].points);
}

TEST(ObjectShapes, APredictionIsNotSeenWhereNothingIsOrWhatIsThereRests) {
  for (const bool parked : {false, true}) {
    Crossing crossing(-3);
    for (int frame = 0; frame < 4; ++frame) crossing.look(ObjectState::kMoving);
    const SE3 T_before = crossing.T_cam_car(3);
    const FrameEstimate online =
        crossing.look(ObjectState::kPredicted, Scene(parked ? std::optional(T_before) : std::nullopt));
    ASSERT_EQ(online.objects.size(), 1U) << parked;
    EXPECT_EQ(online.objects[0].state, ObjectState::kPredicted) << parked;
    EXPECT_TRUE(crossing.masks().empty()) << parked;
    EXPECT_EQ(crossing.finish()[4].objects[0].state, ObjectState::kPredicted) << parked;
  }
}

TEST(ObjectShapes, APredictionIsNotSeenWhereMotionCannotBeTold) {
  Crossing crossing(-1, 0.3);  // less than two cells of an outline in a frame
  for (int frame = 0; frame < 4; ++frame) crossing.look(ObjectState::kMoving);
  EXPECT_EQ(crossing.look(ObjectState::kPredicted).objects[0].state, ObjectState::kPredicted);
}

TEST(ObjectShapes, APredictionThatHasLeftTheImageIsDropped) {
  Crossing crossing(7.2);
  for (int frame = 0; frame < 4; ++frame) crossing.look(ObjectState::kMoving);
  ASSERT_EQ(crossing.look(ObjectState::kPredicted, Scene(std::nullopt)).objects.size(), 1U);  // half of it
  for (int frame = 5; frame < 7; ++frame) crossing.look(ObjectState::kPredicted, Scene(std::nullopt));
  EXPECT_TRUE(crossing.look(ObjectState::kPredicted, Scene(std::nullopt)).objects.empty());
  EXPECT_TRUE(crossing.finish()[7].objects.empty());
}

/// Points that still go along with it are those of another vehicle.
TEST(ObjectShapes, WhatHasLeftTheImageWhollyIsDroppedEvenIfItSeemsToBeSeen) {
  Crossing crossing(7.2);
  for (int frame = 0; frame < 4; ++frame) ASSERT_EQ(crossing.look(ObjectState::kMoving).objects.size(), 1U);
  std::size_t rows = 1;
  for (int frame = 4; frame < 14; ++frame) rows = crossing.look(ObjectState::kMoving).objects.size();
  EXPECT_EQ(rows, 0U);
  EXPECT_TRUE(crossing.finish()[13].objects.empty());
}

/// A car that crosses is estimated where the street is empty: what is seen densely contradicts it, and so does a
/// tracker that finds it at rest.
TEST(ObjectShapes, BelieveInWhatMovesInTheImages) {
  Crossing crossing(-6), imagined(-6), standing(-6);
  double there = 0, not_there = 1, stands = 1;
  for (int frame = 0; frame < 8; ++frame) {
    there = crossing.look(ObjectState::kMoving).objects[0].existence_probability;
    not_there = imagined.look(ObjectState::kMoving, Scene({})).objects[0].existence_probability;
    stands = standing.look(ObjectState::kStopped, Scene({})).objects[0].existence_probability;
  }
  EXPECT_GT(there, 0.95);
  EXPECT_LT(not_there, 0.7);
  EXPECT_LT(stands, not_there - 0.1);
  for (const FrameEstimate& final : crossing.finish()) EXPECT_GT(final.objects[0].existence_probability, 0.95);
}

TEST(ObjectShapes, DoubtOnceWhatWasBornSlow) {
  Crossing crossing(-6), slow(-6);
  slow.born_slow = true;
  const auto logOdds = [](const FrameEstimate& frame) {
    const double p = frame.objects[0].existence_probability;
    return std::log(p / (1 - p));
  };
  const double first = logOdds(crossing.look(ObjectState::kMoving)) - logOdds(slow.look(ObjectState::kMoving));
  EXPECT_GT(first, std::log(9) - 0.1);
  for (int frame = 1; frame < 3; ++frame)
    EXPECT_LT(logOdds(crossing.look(ObjectState::kMoving)) - logOdds(slow.look(ObjectState::kMoving)), 1.5 * first);
}

TEST(ObjectShapes, LeaveOutRowsThatAreUnlikely) {
  Crossing imagined(-6, 8, {.min_existence = 0.7});
  for (int frame = 0; frame < 7; ++frame) imagined.look(ObjectState::kMoving, Scene({}));
  EXPECT_TRUE(imagined.look(ObjectState::kMoving, Scene({})).objects.empty());
  EXPECT_TRUE(imagined.masks().empty());
  for (const FrameEstimate& final : imagined.finish()) EXPECT_TRUE(final.objects.empty());
}

}  // namespace
}  // namespace motorcade
