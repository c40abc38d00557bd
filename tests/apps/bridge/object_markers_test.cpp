#include "apps/bridge/messages/object_markers.hpp"

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

#include "tests/apps/bridge/results_by_hand.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using Type = ros::Marker::Type;

/// A car ahead and to the left of the camera, turned to the left, at 5 m/s.
Result::Object car(std::int64_t id) {
  Result::Object object;
  object.id = id;
  object.T_world_body = rowsOf(turned({0, 0, kHalfTurn / 2}, {20, 3, 0}));
  object.velocity_world_mps = {0, 5, 0};
  object.box_center_body_m = {-1, 0, 0.5};
  object.box_size_m = {4, 2, 1.5};
  return object;
}

Result withObjects(std::vector<Result::Object> objects) {
  Result result;
  result.stamp_ns = 5'000'000'000;
  result.objects = std::move(objects);
  return result;
}

/// "ns id action" of each.
std::vector<std::string> lifeOf(const ros::MarkerArray& array) {
  std::vector<std::string> life;
  for (const ros::Marker& marker : array.markers)
    life.push_back(marker.ns + " " + std::to_string(marker.id) + " " +
                   std::to_string(static_cast<std::int32_t>(marker.action)));
  return life;
}

Eigen::Vector3d at(const ros::Vector3& v) { return {v.x, v.y, v.z}; }

TEST(ObjectMarkers, AreACubeALabelAndAnArrowInTheWorld) {
  ObjectMarkers markers({.frame_id = "odom", .lifetime_s = 1.5});
  markers(withObjects({}));
  const ros::MarkerArray array = markers(withObjects({car(7)}));
  ASSERT_THAT(lifeOf(array), ElementsAre("box 7 0", "label 7 0", "velocity 7 0"));
  const ros::Marker &box = array.markers[0], &label = array.markers[1], &velocity = array.markers[2];
  EXPECT_EQ(box.header.frame_id, "odom");
  EXPECT_EQ(box.header.stamp.sec, 5);
  EXPECT_EQ(box.lifetime_ns, 1'500'000'000);
  EXPECT_EQ(box.type, Type::kCube);
  EXPECT_THAT(at(box.pose.position), IsNear(Eigen::Vector3d(20, 2, 0.5), kRounding)) << "a meter behind, along -y";
  EXPECT_NEAR(box.pose.orientation.z, std::sqrt(0.5), kRounding);
  EXPECT_EQ(at(box.scale), Eigen::Vector3d(4, 2, 1.5)) << "length, width and height along the body's axes";
  EXPECT_EQ(label.type, Type::kText);
  EXPECT_EQ(label.text, "7: 5.0 m/s");
  EXPECT_GT(label.pose.position.z, 0.5 + 1.5 / 2) << "above the cube";
  EXPECT_EQ(velocity.type, Type::kArrow);
  ASSERT_EQ(velocity.points.size(), 2U);
  EXPECT_THAT(at(velocity.points[0]), IsNear(Eigen::Vector3d(20, 2, 0.5), kRounding));
  EXPECT_THAT(at(velocity.points[1]), IsNear(Eigen::Vector3d(20, 7, 0.5), kRounding)) << "where it is in a second";
  EXPECT_EQ(velocity.pose.orientation.w, 1) << "its points are in the world as they are";
}

TEST(ObjectMarkers, BeginByDeletingAllAndDeleteWhatVanished) {
  ObjectMarkers markers({.frame_id = "odom"});
  EXPECT_THAT(lifeOf(markers(withObjects({car(1), car(2)}))),
              ElementsAre(" 0 3", "box 1 0", "label 1 0", "velocity 1 0", "box 2 0", "label 2 0", "velocity 2 0"));
  EXPECT_THAT(lifeOf(markers(withObjects({car(2)}))),
              ElementsAre("box 2 0", "label 2 0", "velocity 2 0", "box 1 2", "label 1 2", "velocity 1 2"));
  EXPECT_THAT(lifeOf(markers(withObjects({car(2)}))), ElementsAre("box 2 0", "label 2 0", "velocity 2 0"))
      << "deleted once";
  EXPECT_THAT(lifeOf(markers(withObjects({}))), ElementsAre("box 2 2", "label 2 2", "velocity 2 2"));
  EXPECT_THAT(lifeOf(markers(withObjects({}))), IsEmpty());
}

TEST(ObjectMarkers, LeaveOutWhatIsNotKnownAndDeleteItWhereItWasShown) {
  ObjectMarkers markers({.frame_id = "odom"});
  markers(withObjects({car(1)}));
  Result::Object stopped = car(1);
  stopped.velocity_world_mps = {0, 0, 0};
  EXPECT_THAT(lifeOf(markers(withObjects({stopped}))), ElementsAre("box 1 0", "label 1 0", "velocity 1 2"));
  stopped.box_size_m = {0, 0, 0};
  EXPECT_THAT(lifeOf(markers(withObjects({stopped}))), ElementsAre("label 1 0", "box 1 2"));
}

TEST(ObjectMarkers, HaveTheColorOfTheirState) {
  ObjectMarkers markers({.frame_id = "odom"});
  markers(withObjects({}));
  const auto color = [&](Result::State state) {
    Result::Object object = car(1);
    object.state = state;
    const ros::Color c = markers(withObjects({object})).markers.front().color;
    return std::array{c.r, c.g, c.b, c.a};
  };
  const auto moving = color(Result::State::kMoving), stopped = color(Result::State::kStopped),
             predicted = color(Result::State::kPredicted);
  EXPECT_NE(moving, stopped);
  EXPECT_NE(moving, predicted);
  EXPECT_NE(stopped, predicted);
  EXPECT_LT(predicted[3], moving[3]) << "what is not seen is faint";
}

TEST(ObjectMarkers, HaveIdsOfThirtyTwoBits) {
  ObjectMarkers markers({.frame_id = "odom"});
  markers(withObjects({}));
  EXPECT_EQ(markers(withObjects({car((std::int64_t{1} << 31) + 5)})).markers.front().id, 5);
}

}  // namespace
}  // namespace motorcade::test
