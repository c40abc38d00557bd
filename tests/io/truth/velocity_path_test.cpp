#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "io/layouts/open_sequence.hpp"
#include "io/truth/ground_truth.hpp"
#include "tests/io/temporary_folder.hpp"
#include "tests/support/data_folder.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::IsNearPose;
using test::messageOf;
using testing::HasSubstr;

TEST(VelocityPath, AnArcIsThatOfItsVelocitiesWhateverThePositionsSay) {
  constexpr double kSpeed_mps = 12, kTurn_radps = 0.3, kInterval_s = 0.1, kRadius_m = kSpeed_mps / kTurn_radps;
  std::vector<OxtsPacket> packets;
  std::vector<Timestamp> stamps;
  for (int i = 0; i < 50; ++i) {
    OxtsPacket packet{.latitude_deg = 49, .longitude_deg = 8, .altitude_m = 100, .velocity_mps = {}};
    packet.yaw_rad = 0.4 + kTurn_radps * kInterval_s * i;
    packet.velocity_mps = Eigen::Vector3d(kSpeed_mps, 0, 0.5);
    packets.push_back(packet);
    stamps.push_back({i * 100'000'000LL});
  }
  const auto poses = velocityPoses(packets, stamps, "oxts.txt");
  ASSERT_EQ(poses.size(), packets.size());
  for (int i = 0; i < 50; i += 7) {
    const double yaw_rad = packets[i].yaw_rad;
    const Eigen::Vector3d place_m{kRadius_m * (std::sin(yaw_rad) - std::sin(0.4)),
                                  kRadius_m * (std::cos(0.4) - std::cos(yaw_rad)), 0.5 * kInterval_s * i};
    constexpr double kChords = 5e-3;  // a chord is shorter than its arc by 4e-5 of it
    EXPECT_THAT(poses[i], IsNearPose(SE3(expSO3({0, 0, yaw_rad}), place_m), kChords)) << i;
  }
}

TEST(VelocityPath, VelocitiesStayLevelWhereTheUnitPitches) {
  OxtsPacket packet;
  packet.pitch_rad = 0.2;
  packet.velocity_mps = Eigen::Vector3d(10, 0, 0);
  const auto poses = velocityPoses({packet, packet}, {Timestamp{0}, Timestamp{1'000'000'000}}, "oxts.txt");
  EXPECT_NEAR(poses[1].translation().x(), 10, 1e-12);
  EXPECT_NEAR(poses[1].translation().z(), 0, 1e-12);
  EXPECT_NEAR(logSO3(poses[1].rotation()).y(), 0.2, 1e-12) << "the attitude has the pitch";
}

TEST(VelocityPath, PacketsWithoutVelocitiesAreNamed) {
  EXPECT_THAT(messageOf<InputError>([] { velocityPoses({OxtsPacket{}}, {Timestamp{}}, "drive/oxts.txt"); }),
              HasSubstr("drive/oxts.txt: packet 0 has no velocity"));
}

TEST(VelocityPath, OnARealDriveItAgreesWithThePositions) {
  const auto folder = test::dataFolder() / "kitti_tracking_0003";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  const Sequence sequence = openSequence(folder);
  const auto by_velocity = readCameraTruth(sequence, OxtsTimes::kVelocities), told = readCameraTruth(sequence);
  ASSERT_TRUE(by_velocity);
  ASSERT_EQ(by_velocity->T_world_cam.size(), sequence.frames.size());
  EXPECT_THAT(by_velocity->source, HasSubstr("velocities (interpolated)"));
  for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
    constexpr double kShare = 0.02, kAtRest_m = 0.05;  // the unit's yaw is off its course by .7 deg
    const double way_m = told->T_world_cam[i].translation().norm();
    EXPECT_NEAR(by_velocity->T_world_cam[i].translation().norm(), way_m, kShare * way_m + kAtRest_m) << i;
    EXPECT_LT(logSO3(by_velocity->T_world_cam[i].rotation().transpose() * told->T_world_cam[i].rotation()).norm(), 1e-3)
        << i;
  }
}

}  // namespace
}  // namespace motorcade
