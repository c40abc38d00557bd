#include <algorithm>
#include <functional>
#include <map>
#include <numbers>
#include <set>
#include <string>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "apps/synth/models/models.hpp"
#include "apps/synth/output/ground_truth.hpp"
#include "tests/apps/synth/rendered_scene.hpp"

namespace motorcade::synth {
namespace {

const StereoCamera kLargeCamera = kittiCamera(828, 250);
constexpr int kId = 3;

/// One thing on an empty road, `ahead_m` before the camera, after `driven_m` of its way across the picture.
Scene alone(Model model, double ahead_m, double driven_m, double heading_rad) {
  Scene scene;
  const auto road = std::make_shared<const Path>(Eigen::Vector2d(-20, 0), 0, std::vector<Path::Piece>{{120, 0}});
  scene.roads = RoadNetwork({Road{road, 12, {}}});
  scene.ego.trajectory.path = road;
  scene.ego.trajectory.start_m = 20;
  const Eigen::Vector2d start =
      Eigen::Vector2d(ahead_m, 0) - driven_m * Eigen::Vector2d(std::cos(heading_rad), std::sin(heading_rad));
  Trajectory trajectory;
  trajectory.path = std::make_shared<const Path>(start, heading_rad, std::vector<Path::Piece>{{50, 0}});
  trajectory.speed_mps = driven_m / scene.frame_s;
  scene.movers.push_back({std::make_shared<const Model>(std::move(model)), trajectory, kId});
  return scene;
}
constexpr int kFrame = 1;  // when the way is covered

struct Kind {
  const char* type;
  std::function<Model(std::uint32_t seed)> make;
  double ahead_m;             // where all of it is in the picture
  Eigen::Vector3d low, high;  // length, width, height: of the objects labeled in KITTI, and of European vehicles
};
const std::vector<Kind> kKinds{
    {"Pedestrian", makePedestrian, 8, {0.4, 0.4, 1.5}, {1.2, 0.8, 1.95}},
    {"Cyclist", makeCyclist, 8, {1.65, 0.5, 1.5}, {1.95, 0.8, 1.95}},
    {"Bus", makeBus, 24, {11, 2.5, 2.9}, {12.5, 3.0, 3.4}},
    {"Trailer", makeTrailer, 20, {7, 2.4, 3.2}, {8.5, 2.6, 3.8}},
    {"Truck",
     [](std::uint32_t seed) { return makeVehicle(VehicleKind::kTruck, seed); },
     20,
     {7.4, 2.3, 3.3},
     {9.2, 2.7, 3.9}},
    {"Car",
     [](std::uint32_t seed) { return makeVehicle(VehicleKind::kCar, seed, Finish::kSmoothDark); },
     10,
     {3.9, 1.8, 1.4},
     {4.7, 2.3, 1.9}},
};

TEST(SynthKinds, HaveTheSizesOfTheirKind) {
  for (const Kind& kind : kKinds)
    for (std::uint32_t seed = 1; seed <= 20; ++seed) {
      const Model model = kind.make(seed);
      EXPECT_EQ(model.kitti_type, kind.type);
      const Eigen::Vector3d size(model.length_m, model.width_m, model.height_m);
      EXPECT_TRUE((size.array() >= kind.low.array()).all() && (size.array() <= kind.high.array()).all())
          << kind.type << " seed " << seed << ": " << size.transpose();
    }
}

TEST(SynthKinds, TheLabelsBoxFitsTheMaskInEveryPose) {
  constexpr double kSampling_px = 1.3;  // masks know the centers of pixels only; round parts are held within 1 %
  for (const Kind& kind : kKinds)
    for (const double driven_m : {0.0, 1.2}) {
      const Scene scene = alone(kind.make(7), kind.ahead_m, driven_m, 1.3);
      const FrameScene frame(scene, kFrame, true);
      const Rendering left = render(frame, kLargeCamera, StereoSide::kLeft, kNoNoise);
      const auto labels = labelsOf(frame, kLargeCamera, left);
      ASSERT_EQ(labels.size(), 1U) << kind.type;
      const Label& label = labels.front();
      EXPECT_EQ(label.id, kId);
      EXPECT_EQ(label.occluded, 0);
      Eigen::AlignedBox2d mask;
      for (const Eigen::Vector2d& pixel : pixelsOf(left, kLargeCamera, kId)) mask.extend(pixel);
      const Eigen::Vector4d seen(mask.min().x(), mask.min().y(), mask.max().x(), mask.max().y());
      const Eigen::Vector4d told(label.left_px, label.top_px, label.right_px, label.bottom_px);
      EXPECT_LT((seen - told).cwiseAbs().maxCoeff(), kSampling_px)
          << kind.type << " after " << driven_m << ": " << seen.transpose() << " and " << told.transpose();
    }
}

/// The hull points of a thing and its limbs, in its own frame.
std::vector<Eigen::Vector3d> pointsOf(const FrameScene& frame) {
  std::vector<Eigen::Vector3d> points;
  const auto object = frame.objects().front();
  for (const Placed& placed : object)
    for (const auto& part : placed.model->parts)
      for (const Vec3& p : hullPoints(part, placed.model->cuts.data()))
        points.push_back(object.front().T_map_body.inverse() * placed.T_map_body * Eigen::Vector3d(p.x, p.y, p.z));
  return points;
}

TEST(SynthKinds, PeopleAndCyclistsMoveTheirLimbsWithinTheirBoxAndTouchTheGround) {
  for (const auto make : {makePedestrian, makeCyclist})
    for (const std::uint32_t seed : {1U, 2U, 3U}) {
      const Model model = make(seed);
      double shortest_m = 1e9, longest_m = 0;
      for (double driven_m = 1; driven_m < 6; driven_m += 0.07) {
        const Scene scene = alone(model, 8, driven_m, 0);
        Eigen::AlignedBox3d box;
        for (const Eigen::Vector3d& p : pointsOf(FrameScene(scene, kFrame, true))) box.extend(p);
        constexpr double kBetweenPoses_m = 0.01;  // the box is fitted to 32 poses of a cycle
        EXPECT_LT(2 * std::max(box.max().x(), -box.min().x()), model.length_m + kBetweenPoses_m);
        EXPECT_LT(box.max().z(), model.height_m + kBetweenPoses_m);
        EXPECT_NEAR(box.min().z(), 0, 0.012) << model.kitti_type << " after " << driven_m;  // round parts: 1 %
        shortest_m = std::min(shortest_m, box.sizes().x());
        longest_m = std::max(longest_m, box.sizes().x());
      }
      if (model.kitti_type == "Pedestrian") {
        EXPECT_GT(longest_m, shortest_m + 0.25);  // legs swing
      }
    }
}

TEST(SynthKinds, ACyclistsFeetStayOnThePedals) {
  const Model model = makeCyclist(5);
  for (double driven_m = 0; driven_m < 5; driven_m += 0.3) {
    const FrameScene frame(alone(model, 8, driven_m, 0), kFrame, true);
    // The cranks are the limb after both wheels; the feet end the legs.
    const auto object = frame.objects().front();
    const SE3 T_body_map = object.front().T_map_body.inverse();
    const SE3 T_body_cranks = T_body_map * object[3].T_map_body;
    std::vector<Eigen::Vector3d> pedals;
    for (const double side : {-1.0, 1.0})
      pedals.push_back(T_body_cranks * Eigen::Vector3d(0, 0.13 * side, 0.17 * side));
    for (const Eigen::Vector3d& pedal : pedals) {
      double nearest_m = 1e9;
      for (const Placed& placed : object)
        nearest_m = std::min(nearest_m, (T_body_map * placed.T_map_body.translation() - pedal).norm());
      EXPECT_LT(nearest_m, 0.15) << "after " << driven_m;  // from the middle of the pedal to the ankle
    }
  }
}

TEST(SynthKinds, ALimbTurnsFromZTowardsX) {
  Model limb, model;
  limb.add(Material::kCloth, {-0.1F, -0.1F, 0.9F}, {0.1F, 0.1F, 1.1F}, 0.5F);
  model.addLimb(std::move(limb), [](double driven_m) { return Limb::Pose{{0, 0, 2}, driven_m}; });
  const Eigen::Vector3d p = model.limbs.front().T_parent_limb(0.5 * std::numbers::pi) * Eigen::Vector3d(0, 0, 1);
  EXPECT_LT((p - Eigen::Vector3d(1, 0, 2)).norm(), 1e-9);
}

TEST(SynthKinds, ARingIsOpenInTheMiddle) {
  Model model;
  model.addCylinder(Material::kTire, 1, {-1, -0.1F, -1}, {1, 0.1F, 1}, 0.1F).hole = 0.8F;
  const auto hit = [&](const Vec3& origin, const Vec3& direction) {
    return intersect(model.parts.front(), nullptr, origin, direction, 0, 100);
  };
  EXPECT_FALSE(hit({0.5F, -3, 0}, {0, 1, 0}));
  ASSERT_TRUE(hit({0.9F, -3, 0}, {0, 1, 0}));
  EXPECT_FLOAT_EQ(hit({0.9F, -3, 0}, {0, 1, 0})->t, 2.9F);
  // In through the hole, slanted: on to the far wall from within.
  const auto inner = hit({0, -3, 0}, {0.27F, 1, 0});
  ASSERT_TRUE(inner);
  EXPECT_NEAR(0.27F * inner->t, 0.8F, 1e-4F);
  EXPECT_LT(inner->normal.x, -0.9F);
}

}  // namespace
}  // namespace motorcade::synth
