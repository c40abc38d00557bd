#include "frontend/tracking/region_walkers.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "tests/frontend/tracking/labelled_street.hpp"

namespace motorcade {
namespace {

using test::kNarrowRig;
using test::LabelledStreet;

const LabelledStreet::Board kWalks{.walk_mps = 1.4};

/// A few corners on the board.
std::vector<Eigen::Vector3d> cornersOn(const LabelledStreet& street) {
  std::vector<Eigen::Vector3d> points_px;
  for (const double right_m : {-0.2, 0.15})
    for (const double down_m : {-0.6, -0.1, 0.4}) points_px.push_back(street.onBoard_px(right_m, down_m));
  return points_px;
}

std::optional<MotionComponent> walkerIn(const Box& labelled, const SceneMotion& scene, const LabelledStreet& street,
                                        std::vector<bool> taken = {}) {
  taken.resize(scene.points.size());
  const RegionWalkers walkers(street.past, kNarrowRig);
  const auto candidates = walkers.candidates(scene, taken, taken, LabelledStreet::T_world_cam());
  if (candidates.empty()) return std::nullopt;
  EXPECT_EQ(candidates.size(), 1U);
  const Box& found = candidates.front().region.box;
  EXPECT_EQ(found.left_px, labelled.left_px);
  EXPECT_EQ(found.bottom_px, labelled.bottom_px);
  const auto mover = walkers(candidates.front(), scene, LabelledStreet::T_world_cam());
  return mover ? std::optional(mover->component) : std::nullopt;
}
std::optional<MotionComponent> walkerIn(const Box& labelled, const std::vector<Eigen::Vector3d>& points_px,
                                        const LabelledStreet& street) {
  return walkerIn(labelled, *street.now(labelled, points_px), street);
}

TEST(RegionWalkers, FindWhoWalksWhereALabelIs) {
  const LabelledStreet street(kWalks);
  const auto walker = walkerIn(street.boardBox(), cornersOn(street), street);
  ASSERT_TRUE(walker);
  EXPECT_EQ(walker->points, (std::vector{0, 1, 2, 3, 4, 5}));
  EXPECT_NEAR(walker->velocity_mps.x(), street.velocity_cam_mps().x(), 0.2);
  EXPECT_NEAR(walker->velocity_mps.y(), 0, 0.2);
  EXPECT_LT(std::abs(walker->velocity_mps.z() - street.velocity_cam_mps().z()), 1.5) << "as people walk";
  const Eigen::Vector3d middle_cam = kNarrowRig.triangulate(street.onBoard_px(0, 0));
  EXPECT_NEAR(walker->centroid_cam.x(), middle_cam.x(), 0.1);
  EXPECT_NEAR(walker->centroid_cam.z(), middle_cam.z(), 0.5);
}

/// A point that is found again in another place than at rest tells where to look.
TEST(RegionWalkers, FindWhoWalksWithoutALabel) {
  for (const double walk_mps : {-1.4, 0.0, 1.4}) {
    const LabelledStreet street({.walk_mps = walk_mps});
    const auto scene = street.withoutLabels({street.onBoard_px(0.1, -0.2)});
    const RegionWalkers walkers(street.past, kNarrowRig);
    const auto candidates = walkers.candidates(*scene, {false}, {false}, LabelledStreet::T_world_cam());
    ASSERT_EQ(candidates.size(), walk_mps == 0 ? 0U : 1U) << walk_mps;
    if (candidates.empty()) continue;
    EXPECT_EQ(candidates[0].region.label, 0);
    const auto mover = walkers(candidates[0], *scene, LabelledStreet::T_world_cam());
    ASSERT_TRUE(mover) << walk_mps;
    EXPECT_EQ(mover->component.points, std::vector{0});
    EXPECT_NEAR(mover->component.velocity_mps.x(), street.velocity_cam_mps().x(), 0.2);
    EXPECT_NEAR(mover->component.centroid_cam.z(), kNarrowRig.triangulate(street.onBoard_px(0, 0)).z(), 0.5);
  }
}

TEST(RegionWalkers, LeaveOutPointsOnOthers) {
  const LabelledStreet street(kWalks);
  const Box box = street.boardBox();
  std::vector<Eigen::Vector3d> points_px = cornersOn(street);
  const int own = static_cast<int>(points_px.size());
  points_px.push_back(street.onBoard_px(0, -0.7));
  points_px.back().z() = LabelledStreet::onWall_px(0, 0).z();  // the wall, on a pixel that is labelled
  points_px.push_back(street.onBoard_px(0, 0.2));              // not as the person moves
  points_px.push_back(street.onBoard_px(0, 0.83));             // the road at the feet
  points_px.push_back(street.onBoard_px(0.9, 0));              // beside the label
  const auto scene = street.now(box, points_px);
  SceneFlow& other = scene->points[own + 1].flow.emplace();
  other.p_cam = kNarrowRig.triangulate(scene->points[own + 1].uvd_px);
  other.velocity_mps = {-1.4, 0, 0};
  other.covariance = 0.01 * Eigen::Matrix<double, 6, 6>::Identity();
  scene->points[own + 2].label = PointLabel::kGround;
  scene->points[0].flow = other;
  scene->points[0].flow->velocity_mps = street.velocity_cam_mps();
  const auto walker = walkerIn(box, *scene, street);
  ASSERT_TRUE(walker);
  EXPECT_EQ(walker->points, (std::vector{0, 1, 2, 3, 4, 5}));
}

TEST(RegionWalkers, LeaveAloneWhoStands) {
  for (const unsigned seed : {1U, 2U}) {
    const LabelledStreet street({.walk_mps = 0, .seed = seed});
    EXPECT_FALSE(walkerIn(street.boardBox(), cornersOn(street), street)) << seed;
  }
}

TEST(RegionWalkers, LeaveAloneWhatIsKnown) {
  const LabelledStreet street(kWalks);
  const auto scene = street.now(street.boardBox(), cornersOn(street));
  std::vector<bool> taken(scene->points.size());
  EXPECT_TRUE(walkerIn(street.boardBox(), *scene, street, taken));
  taken[3] = true;
  EXPECT_FALSE(walkerIn(street.boardBox(), *scene, street, taken));
  scene->points.clear();
  EXPECT_FALSE(walkerIn(street.boardBox(), *scene, street)) << "nothing tells how far away it is";
}

/// Labels of a person's size all over the wall, some of which hold a part of the board.
TEST(RegionWalkers, BelieveNoLabelOfWhatRests) {
  const LabelledStreet street(kWalks);
  int labels = 0;
  for (const double x_m : {-3.0, -2.0, -1.0, 3.0, 4.0})
    for (const double y_m : {-1.5, 0.0, 1.5}) {
      const Eigen::Vector3d middle_px = LabelledStreet::onWall_px(x_m, y_m);
      const Box box = LabelledStreet::around(middle_px, 0.35, 0.9);
      if (!kNarrowRig.inLeftImage(box.left_px, box.top_px) || !kNarrowRig.inLeftImage(box.right_px, box.bottom_px))
        continue;
      ++labels;
      EXPECT_FALSE(walkerIn(box, {middle_px}, street)) << x_m << " " << y_m;
    }
  EXPECT_GE(labels, 9);
}

/// A board of a car's size that moves as a person walks: a label of all of it, and one of a person's size on it.
TEST(RegionWalkers, AreNoLargerThanPeople) {
  const LabelledStreet street({.walk_mps = 1.4, .width_m = 1.9, .height_m = 1.5});
  EXPECT_FALSE(walkerIn(street.boardBox(), cornersOn(street), street));
  const Box part = LabelledStreet::around(street.onBoard_px(0, 0), 0.4, 0.7);
  EXPECT_FALSE(walkerIn(part, cornersOn(street), street)) << "the body goes on beside the label";
}

/// Late labels show where a person was.
TEST(RegionWalkers, BelieveNoLabelBesideItsBody) {
  const LabelledStreet street(kWalks);
  for (const double aside_m : {-0.3, 0.3}) {
    const Box late = LabelledStreet::around(street.onBoard_px(aside_m, 0), 0.3, 0.85);
    EXPECT_FALSE(walkerIn(late, {street.onBoard_px(0.5 * aside_m, 0)}, street)) << aside_m;
  }
}

TEST(RegionWalkers, GoAcrossNeitherSlowerNorFasterThanPeopleWalk) {
  for (const double speed_mps : {0.4, 4.0}) {
    const LabelledStreet street({.walk_mps = speed_mps});
    EXPECT_FALSE(walkerIn(street.boardBox(), cornersOn(street), street)) << speed_mps;
  }
}

/// Endless labels, each of a person's size, take no more time than some of them.
TEST(RegionWalkers, LookAtSomeOfTooManyLabelsAndAtOthersInTheNextFrame) {
  const LabelledStreet street(kWalks);
  constexpr int kColumns = 20, kRows = 4, kSide_px = 8;
  std::vector<Eigen::Vector3d> points_px;
  const double near_px = kNarrowRig.fx_px * kNarrowRig.baseline_m / 40;  // where so little is as high as a child
  for (int label = 0; label < kColumns * kRows; ++label)
    points_px.emplace_back(10 + kSide_px * (label % kColumns), 10 + 2 * kSide_px * (label / kColumns), near_px);
  const auto scene = street.now(street.boardBox(), {});
  auto labels = std::make_shared<InstanceLabels>(kNarrowRig.width_px, kNarrowRig.height_px);
  for (std::size_t k = 0; k < points_px.size(); ++k) {
    const auto label = static_cast<std::uint16_t>(k + 1);
    for (int v = -5; v <= 5; ++v)
      for (int u = -2; u <= 2; ++u)
        labels->mutableRow(static_cast<int>(points_px[k].y()) + v)[static_cast<int>(points_px[k].x()) + u] = label;
    scene->points.push_back({.point = {static_cast<std::int64_t>(k)},
                             .uvd_px = points_px[k],
                             .sigma_px = Eigen::Vector3d::Constant(0.3),
                             .instance = label,
                             .flow = {}});
  }
  auto pair = std::make_shared<StereoFrame>();
  pair->inputs.instances = labels;
  auto features = std::make_shared<Features>();
  features->frame = pair;
  scene->features = features;
  const RegionWalkers walkers(street.past, kNarrowRig);
  const std::vector<bool> taken(scene->points.size());
  std::set<std::uint16_t> seen;
  for (int frame = 0; frame < 6; ++frame) {
    scene->head.frame = {frame};
    const auto candidates = walkers.candidates(*scene, taken, taken, LabelledStreet::T_world_cam());
    EXPECT_EQ(candidates.size(), 32U) << frame;
    for (const auto& candidate : candidates) seen.insert(candidate.region.label);
  }
  EXPECT_EQ(seen.size(), points_px.size());
}

}  // namespace
}  // namespace motorcade
