#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <gmock/gmock.h>

#include "apps/bridge/bridge_parts.hpp"
#include "apps/bridge/dds/dds_configuration.hpp"
#include "apps/bridge/messages/message_conversion.hpp"
#include "io/files/errors.hpp"
#include "tests/apps/bridge/results_by_hand.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/numeric_jacobian.hpp"

/// Tests the messages of ROS 2 that results become, and the command line of `motorcade bridge`.
namespace motorcade::test {
namespace {

using testing::HasSubstr;

TEST(BridgeMessages, StampsAreThoseOfTheCapture) {
  const auto pair = [](std::int64_t stamp_ns) {
    const ros::Time time = timeOf(stamp_ns);
    return std::pair<std::int64_t, std::int64_t>(time.sec, time.nanosec);
  };
  EXPECT_EQ(pair(0), std::pair(0L, 0L));
  EXPECT_EQ(pair(1'317'042'275'123'456'789), std::pair(1'317'042'275L, 123'456'789L));
  EXPECT_EQ(pair(-1), std::pair(-1L, 999'999'999L)) << "nanoseconds count forward from the second before";
  EXPECT_EQ(pair(-2'000'000'000), std::pair(-2L, 0L));
  EXPECT_EQ(pair(4'000'000'000'000'000'000).first, 2'147'483'647L) << "32 bits hold no later second";
}

TEST(BridgeMessages, QuaternionsAreThoseOfTheRotation) {
  const auto quaternion = [](const Eigen::Vector3d& phi_rad) {
    const ros::Quaternion q = poseOf(turned(phi_rad)).orientation;
    return Eigen::Vector4d(q.x, q.y, q.z, q.w);
  };
  const double half = std::sqrt(0.5);
  EXPECT_THAT(quaternion({0, 0, 0}), IsNear(Eigen::Vector4d(0, 0, 0, 1), kRounding));
  EXPECT_THAT(quaternion({0, 0, kHalfTurn / 2}), IsNear(Eigen::Vector4d(0, 0, half, half), kRounding));
  EXPECT_THAT(quaternion({-kHalfTurn / 2, 0, 0}), IsNear(Eigen::Vector4d(-half, 0, 0, half), kRounding));
  EXPECT_THAT(quaternion({0, kHalfTurn / 3, 0}), IsNear(Eigen::Vector4d(0, 0.5, 0, std::sqrt(0.75)), kRounding));
}

TEST(BridgeMessages, ThePoseIsTheCamerasInTheWorld) {
  Result result;
  result.stamp_ns = 12'000'000'034;
  result.T_world_cam = rowsByHand(turned({0, 0, kHalfTurn / 2}, {1, 2, 3}));
  const ros::PoseStamped message = poseStampedOf(result, {.world = "map", .child = "base_link"});
  EXPECT_EQ(message.header.stamp.sec, 12);
  EXPECT_EQ(message.header.stamp.nanosec, 34U);
  EXPECT_EQ(message.header.frame_id, "map");
  const auto& [x, y, z] = message.pose.position;
  EXPECT_EQ(Eigen::Vector3d(x, y, z), Eigen::Vector3d(1, 2, 3));
  EXPECT_NEAR(message.pose.orientation.z, std::sqrt(0.5), kRounding);
}

/// Compares ROS' perturbation of a pose: of the position, and of the rotation about axes of the parent frame, on the
/// left.
TEST(BridgeMessages, PoseCovarianceIsTurnedAsFiniteDifferencesSay) {
  const SE3 T = turned({0.4, -1.1, 0.7}, {5, -3, 2});
  const Matrix6d J = numericJacobian(
      [&T](const SE3& moved) {
        Vector6d difference;
        difference << moved.translation() - T.translation(), logSO3(moved.rotation() * T.rotation().transpose());
        return difference;
      },
      T);
  const Matrix6d covariance = unevenCovariance();
  const ros::Covariance rows = covarianceInParent(covariance, T.rotation());
  constexpr double kTol = 1e-7;  // of central differences, times the covariance
  EXPECT_THAT(matrixOfRows(rows), IsNear(Matrix6d(J * covariance * J.transpose()), kTol));
}

/// Heads to the left, along y of the world: uncertainty ahead is uncertainty in y, and a roll is one about y.
TEST(BridgeMessages, PoseCovarianceOfAQuarterTurnIsTheHandComputedOne) {
  Vector6d variances;
  variances << 1, 2, 3, 4, 5, 6;
  const ros::Covariance rows =
      covarianceInParent(Matrix6d(variances.asDiagonal()), turned({0, 0, kHalfTurn / 2}).rotation());
  Vector6d expected;
  expected << 2, 1, 3, 5, 4, 6;
  EXPECT_THAT(matrixOfRows(rows), IsNear(Matrix6d(expected.asDiagonal()), kRounding));
}

TEST(BridgeMessages, OdometryHasTheTwistInTheChildsFrame) {
  Result result;
  result.T_world_cam = rowsByHand(turned({0, 0, 1}));
  result.velocity = {10, 0.1, 0.2, 0.01, 0.02, 0.3};
  result.velocity_covariance = rowsByHand(unevenCovariance());
  result.pose_covariance = rowsByHand(diagonal(0.25, 0.01));
  const ros::Odometry message = odometryOf(result, {.world = "odom", .child = "camera"});
  EXPECT_EQ(message.header.frame_id, "odom");
  EXPECT_EQ(message.child_frame_id, "camera");
  EXPECT_EQ(message.linear_mps.x, 10);
  EXPECT_EQ(message.linear_mps.z, 0.2);
  EXPECT_EQ(message.angular_radps.x, 0.01);
  EXPECT_EQ(message.angular_radps.z, 0.3);
  EXPECT_EQ(message.twist_covariance, result.velocity_covariance);
  EXPECT_NEAR(message.pose_covariance[0], 0.25, kRounding);
  EXPECT_NEAR(message.pose_covariance[35], 0.01, kRounding);
}

TEST(BridgeMessages, TheTransformIsThePose) {
  Result result;
  result.stamp_ns = 12'000'000'034;
  result.T_world_cam = rowsByHand(turned({0, 0, kHalfTurn / 2}, {1, 2, 3}));
  const ros::TransformStamped message = transformStampedOf(result, {.world = "odom", .child = "base_link"});
  EXPECT_EQ(message.header.stamp.nanosec, 34U);
  EXPECT_EQ(message.header.frame_id, "odom");
  EXPECT_EQ(message.child_frame_id, "base_link");
  EXPECT_EQ(message.transform.position.y, 2);
  EXPECT_NEAR(message.transform.orientation.z, std::sqrt(0.5), kRounding);
}

TEST(BridgeMessages, WhatIsNotKnownHasAWideCovariance) {
  const ros::Odometry message = odometryOf(Result(), FrameIds());
  EXPECT_EQ(message.pose_covariance, rowsByHand(kUnknownVariance * Matrix6d::Identity()));
}

TEST(BridgeOptions, ThePaceIsTheCapturesUnlessToldOtherwise) {
  EXPECT_EQ(speedOf({}, 10), 1);
  EXPECT_EQ(speedOf({.rate = "5"}, 10), 0.5);
  EXPECT_EQ(speedOf({.rate = "max"}, 10), std::nullopt);
  EXPECT_THROW(speedOf({.rate = "max", .live = true}, 10), UsageError);
  for (const char* const bad : {"0", "-1", "fast", "10x", "nan"}) EXPECT_THROW(speedOf({.rate = bad}, 10), UsageError);
}

TEST(BridgeOptions, FrameIdsAreTwoNames) {
  const FrameIds ids = frameIdsOf({.frame_ids = "map,base_link"});
  EXPECT_EQ(ids.world, "map");
  EXPECT_EQ(ids.child, "base_link");
  EXPECT_EQ(frameIdsOf({}).child, "camera");
  EXPECT_EQ(frameIdsOf({.mounting = "1,0,1,0,0,0"}).child, "base_link");
  EXPECT_EQ(frameIdsOf({.mounting = "1,0,1,0,0,0", .frame_ids = "map,roof"}).child, "roof");
  for (const char* const bad : {"map", "map,", ",camera", "/map,camera", "map,map", "map,a b", "map,a,b"})
    EXPECT_THROW(frameIdsOf({.frame_ids = bad}), UsageError) << bad;
}

TEST(BridgeOptions, TopicsAreNamesOfThoseThatAreKnown) {
  EXPECT_EQ(topicsOf("tf,pose"), (std::set<Topic>{Topic::kPose, Topic::kTf}));
  std::set<Topic> all = topicsOf(kDefaultTopics);
  EXPECT_FALSE(all.contains(Topic::kTf)) << "who publishes a transform twice contradicts himself";
  all.insert(Topic::kTf);
  EXPECT_EQ(all.size(), kTopicCount);
  EXPECT_EQ(rosNamesOf(topicsOf("pose,markers,tf")), "/motorcade/pose, /motorcade/objects and /tf");
  for (const char* const bad : {"", "pose,", "objects", "pose,,tf", "Pose"})
    EXPECT_THROW(topicsOf(bad), UsageError) << bad;
  try {
    topicsOf("pose,objects");
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("'objects'; write some of pose, odometry, markers, tracked_objects"));
  }
}

TEST(BridgeOptions, WithoutAMountingTheCameraIsTheVehicle) {
  EXPECT_THAT(mountingOf({}), IsNearPose(SE3(), 0));
  EXPECT_THAT(mountingOf({.mounting = "1.6,-0.4,1.5,0,0,0"}),
              IsNearPose(turned({0, 0, 0}, {1.6, -0.4, 1.5}), kRounding));
  EXPECT_THROW(mountingOf({.mounting = "1,2,3"}), UsageError);
}

TEST(BridgeOptions, ImagesAreTwoTopicsWithTheirCameraInfo) {
  const auto topics = cameraTopicsOf({.images = "/stereo/left/image_raw,/stereo/right/image_raw/compressed"});
  EXPECT_EQ(topics[0].image, "/stereo/left/image_raw");
  EXPECT_EQ(topics[0].info, "/stereo/left/camera_info");
  EXPECT_EQ(topics[1].image, "/stereo/right/image_raw/compressed");
  EXPECT_EQ(topics[1].info, "/stereo/right/camera_info");
  EXPECT_EQ(cameraTopicsOf({.images = "/a/b,/a/c", .given = {.camera = "1,1,1,1,1"}})[0].info, "");
  for (const char* const bad : {"/l/i", "/l/i,", "l/i,r/i", "/l/i,/l/i", "/l/i,/r/i,/x/i", "/l/i,/r i", "/l/,/r/",
                                "/stereo/left,/stereo/right"})
    EXPECT_THROW(cameraTopicsOf({.images = bad}), UsageError) << bad;
}

TEST(BridgeOptions, TopicsAreLiveUnlessEveryPairIsWanted) {
  EXPECT_EQ(trackerOptionsOf({.images = "/l/i,/r/i"}).policy, Tracker::Policy::kLive);
  EXPECT_EQ(trackerOptionsOf({.images = "/l/i,/r/i", .every_pair = true}).policy, Tracker::Policy::kReplay);
}

TEST(BridgeOptions, TheConfigurationIsReadAndTheAxesAreThoseOfRos) {
  EXPECT_EQ(trackerOptionsOf({}).axes, Tracker::Axes::kRep103);
  EXPECT_EQ(trackerOptionsOf({}).policy, Tracker::Policy::kReplay);
  EXPECT_EQ(trackerOptionsOf({.live = true}).policy, Tracker::Policy::kLive);
  EXPECT_THROW(trackerOptionsOf({.config = "/nonexistent/motorcade.toml"}), UsageError);
}

TEST(DdsConfiguration, IsLoopbackAloneUnlessAnInterfaceIsNamed) {
  for (const char* const interface : {"", "lo", "127.0.0.1"}) {
    const std::string xml = ddsConfiguration({.domain = 3, .interface = interface});
    EXPECT_THAT(xml, HasSubstr("<NetworkInterface address=\"127.0.0.1\" multicast=\"false\"/>")) << interface;
    EXPECT_THAT(xml, HasSubstr("<AllowMulticast>false</AllowMulticast>")) << interface;
    EXPECT_TRUE(isLoopback({.interface = interface}));
  }
}

TEST(DdsConfiguration, RefusesWhatIsNoPlace) {
  for (const char* const bad : {"203.0.113.7", "no_such_interface0", "\"/><evil a=\"", "::1"})
    EXPECT_THROW(ddsConfiguration({.interface = bad}), UsageError) << bad;
  EXPECT_THROW(ddsConfiguration({.domain = 233}), UsageError);
  EXPECT_THROW(ddsConfiguration({.domain = -1}), UsageError);
}

}  // namespace
}  // namespace motorcade::test
