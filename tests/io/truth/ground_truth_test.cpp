#include "io/truth/ground_truth.hpp"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "io/layouts/open_sequence.hpp"
#include "io/truth/trajectory.hpp"
#include "tests/io/temporary_folder.hpp"
#include "tests/support/data_folder.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::IsNearPose;
using test::messageOf;
using testing::HasSubstr;

const std::filesystem::path kData = test::dataFolder();

double largestDifference(const std::vector<SE3>& a, const std::vector<SE3>& b) {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i].inverse() * b.at(i)).log().norm());
  return largest;
}

TEST(GroundTruth, OxtsGiveTheReferencePosesInBothForms) {
  if (!std::filesystem::exists(kData / "kitti_tracking_0003"))
    GTEST_SKIP() << kData / "kitti_tracking_0003"
                 << " is not there";
  Sequence sequence = openSequence(kData / "kitti_tracking_0003");
  const auto uninterpolated = readCameraTruth(sequence, OxtsTimes::kUninterpolated);
  ASSERT_TRUE(uninterpolated);
  constexpr double kPrinted = 2e-4;  // the reference has ten digits over 170 m, the calibration's rotations seven
  EXPECT_LT(largestDifference(uninterpolated->T_world_cam,
                              readKittiPoses(kData / "kitti_tracking_0003/poses_oxts_uninterpolated.txt")),
            kPrinted);
  sequence.truth.poses.clear();
  const auto interpolated = readCameraTruth(sequence);
  ASSERT_TRUE(interpolated);
  // The first image is 1 ms older than the first packet, where the reference keeps the attitude and we continue it:
  // 2e-5 rad, 3.5 mm at the end.
  constexpr double kWayOfInterpolating = 5e-3;
  EXPECT_LT(largestDifference(interpolated->T_world_cam, readKittiPoses(kData / "kitti_tracking_0003/poses.txt")),
            kWayOfInterpolating);
}

TEST(GroundTruth, LabelsAgreeWithTheExactPosesOfARenderedSequence) {
  if (!std::filesystem::exists(kData / "rendered_street"))
    GTEST_SKIP() << kData / "rendered_street"
                 << " is not there";
  Sequence sequence = openSequence(kData / "rendered_street");
  const auto camera = readCameraTruth(sequence);
  const auto exact = readObjectTruths(sequence, *camera);
  sequence.truth.object_poses.clear();
  const auto labeled = readObjectTruths(sequence, *camera);
  ASSERT_EQ(exact->objects.size(), labeled->objects.size());
  for (std::size_t i = 0; i < exact->objects.size(); ++i) {
    constexpr double kPitchOfTheCar = 0.03;  // a label has no pitch and roll
    EXPECT_THAT(labeled->objects[i].T_world_object, IsNearPose(exact->objects[i].T_world_object, kPitchOfTheCar)) << i;
  }
}

/// A folder whose camera drives east at 10 m/s, with a packet every 0.1 s and images 20 ms later.
class OxtsDrive : public testing::Test {
 protected:
  OxtsDrive() {
    sequence_.calibration.R_rect = Eigen::Matrix3d::Identity();
    Eigen::Matrix3d cam_velo;
    cam_velo << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    sequence_.calibration.T_cam_velo = SE3(cam_velo, Eigen::Vector3d::Zero());
    sequence_.calibration.T_velo_imu = SE3();
    sequence_.frames.resize(3);
    std::string oxts, packet_times, image_times;
    constexpr double kLatitude_deg = 49, kRadius_m = 6378137;
    for (int i = 0; i < 3; ++i) {
      const double longitude_deg =
          8 + i / (kRadius_m * std::cos(kLatitude_deg * std::numbers::pi / 180)) * 180 / std::numbers::pi;
      char line[128];
      std::snprintf(line, sizeof(line), "49 %.15g 100 0 0 0 and more\n", longitude_deg);
      oxts += line;
      packet_times += "2011-09-26 13:10:51." + std::to_string(i + 1) + "00000000\n";
      image_times += "2011-09-26 13:10:51." + std::to_string(i + 1) + "20000000\n";
    }
    sequence_.truth.oxts = folder_.write("oxts.txt", oxts);
    sequence_.truth.oxts_timestamps = folder_.write("oxts_timestamps.txt", packet_times);
    sequence_.truth.image_timestamps = folder_.write("image_timestamps.txt", image_times);
  }
  test::TemporaryFolder folder_;
  Sequence sequence_;
};

TEST_F(OxtsDrive, PathIsAheadInTheCamerasFrame) {
  const auto truth = readCameraTruth(sequence_);
  ASSERT_TRUE(truth);
  constexpr double kRounding = 1e-6;  // longitudes with 15 digits
  for (int i = 0; i < 3; ++i)
    EXPECT_THAT(truth->T_world_cam[i],
                IsNearPose(SE3(Eigen::Matrix3d::Identity(), {0, 0, static_cast<double>(i)}), kRounding));
}

TEST_F(OxtsDrive, InterpolationTakesTheTimesIntoAccount) {
  sequence_.truth.image_timestamps =
      folder_.write("image_timestamps.txt",
                    "2011-09-26 13:10:51.100000000\n2011-09-26 13:10:51.250000000\n2011-09-26 13:10:51.300000000\n");
  constexpr double kRounding = 1e-6;
  EXPECT_NEAR(readCameraTruth(sequence_)->T_world_cam[1].translation().z(), 1.5, kRounding);
  EXPECT_NEAR(readCameraTruth(sequence_, OxtsTimes::kUninterpolated)->T_world_cam[1].translation().z(), 1.0, kRounding);
}

TEST_F(OxtsDrive, TooFewPacketsAreNamed) {
  sequence_.frames.resize(4);
  EXPECT_THAT(messageOf<InputError>([&] { readCameraTruth(sequence_); }), HasSubstr("oxts.txt"));
}

TEST(GroundTruth, ColorPairMovesLabelsAndPosesIntoItsLeftCamera) {
  const test::TemporaryFolder folder;
  Sequence sequence;
  sequence.pair = CameraPair::kColor;
  sequence.frames.resize(1);
  Calibration::Projection P2;
  P2 << 700, 0, 300, 70, 0, 700, 100, 0, 0, 0, 1, 0;
  sequence.calibration.P[2] = P2;
  sequence.truth.poses = folder.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  sequence.truth.labels = folder.write("label_02.txt",
                                       "0 -1 DontCare -1 -1 -10 1 2 3 4 -1000 -1000 -1000 -10 -1 -1 -1\n"
                                       "0 3 Car 0 1 -1.6 10 20 30 40 1.5 1.6 4.2 2 1.7 20 -1.57\n");
  const auto truths = readObjectTruths(sequence, *readCameraTruth(sequence));
  ASSERT_EQ(truths->objects.size(), 1u);
  EXPECT_EQ(truths->ignored.size(), 1u);
  constexpr double kX_m = 2.1;  // camera 2 sees it 70 px / 700 px further right
  EXPECT_NEAR(truths->objects[0].T_cam_object.translation().x(), kX_m, 1e-12);
  EXPECT_EQ(truths->objects[0].occluded, 1);
}

}  // namespace
}  // namespace motorcade
