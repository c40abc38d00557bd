#include "apps/evaluate/comparison/truth_check.hpp"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/evaluate/report/report.hpp"
#include "core/messages.hpp"
#include "io/files/errors.hpp"
#include "io/layouts/open_sequence.hpp"
#include "io/truth/trajectory.hpp"
#include "tests/apps/evaluate/evaluated_drive.hpp"
#include "tests/support/data_folder.hpp"
#include "tests/support/noise.hpp"

namespace motorcade {

namespace {

constexpr int kFrames = 2000;
constexpr double kGyroscopes_rad = 0.01 * std::numbers::pi / 180;

std::vector<SE3> arc() {
  std::vector<SE3> poses;
  for (int k = 0; k < kFrames; ++k) poses.push_back(SE3::exp(k * (Vector6d() << 0, 0, 1, 0, 0.01, 0).finished()));
  return poses;
}

TEST(TruthNoise, WhiteNoiseOfPosesIsFoundInTheErrorsOfSuccessiveMotions) {
  test::Noise noise(3);
  Vector6d sigma;
  sigma << 0.02, 0.01, 0.03, 0.0004, 0.0002, 0.0003;
  std::vector<SE3> truth = arc();
  for (SE3& pose : truth) pose = pose * SE3::exp(noise.gaussian(sigma));
  const Matrix6d found = truthNoise(arc(), truth);
  for (int k = 0; k < 6; ++k)
    EXPECT_NEAR(found(k, k), 2 * sigma[k] * sigma[k] + (k < 3 ? 0 : std::pow(kGyroscopes_rad, 2)),
                0.4 * sigma[k] * sigma[k])
        << k;
}

/// Adds errors that last, as those of a wrong calibration do.
TEST(TruthNoise, ErrorsThatLastAreNone) {
  std::vector<SE3> estimate = arc();
  for (int k = 0; k < kFrames; ++k) estimate[k] = SE3::exp(k * (Vector6d() << 0.001, 0, 1.01, 0, 0.0102, 0).finished());
  const Matrix6d found = truthNoise(estimate, arc());
  EXPECT_NEAR((found.topLeftCorner<3, 3>().norm()), 0, 1e-9);
  EXPECT_NEAR(found(4, 4), std::pow(kGyroscopes_rad, 2), 1e-12);
}

TEST(TruthNoise, OfPlacesIsHowFarTheyDifferFromWhereVelocitiesLead) {
  std::vector<SE3> too_fast;
  for (int k = 0; k < kFrames; ++k) too_fast.push_back(SE3::exp(k * (Vector6d() << 0, 0, 1.01, 0, 0.01, 0).finished()));
  const Eigen::Matrix3d found = placeNoise(arc(), too_fast);
  EXPECT_NEAR(std::sqrt(found.trace()), 0.01 * kCameraCovarianceFrames, 2e-3);
}

}  // namespace

}  // namespace motorcade

namespace motorcade::test {
namespace {

using testing::HasSubstr;
using testing::Not;

/// The drive made by hand, at 1 m per frame of .1 s, with the packets of an inertial unit that sits in the camera.
class TruthOfADrive : public EvaluateDrive {
 protected:
  TruthOfADrive() {
    std::string times;
    for (int i = 0; i < kFrames; ++i) times += std::to_string(i * 0.1) + "\n";
    folder_.write("drive/times.txt", times);
    folder_.write("drive/calib.txt",
                  "P0: 700 0 32 0 0 700 16 0 0 0 1 0\nP1: 700 0 32 -350 0 700 16 0 0 0 1 0\nR_rect 1 0 0 0 1 0 0 0 1\n"
                  "Tr_velo_cam 0 -1 0 0 0 0 -1 0 1 0 0 0\nTr_imu_velo 1 0 0 0 0 1 0 0 0 0 1 0\n");
    writeRun("run", 0, kFrames, [](int, FrameEstimate&) {});
  }
  /// Packets that go ahead at this speed.
  void writePackets(double speed_mps) {
    std::string oxts;
    for (int i = 0; i < kFrames; ++i) oxts += "49 8 100 0 0 0 0 0 " + std::to_string(speed_mps) + " 0 0\n";
    folder_.write("drive/oxts.txt", oxts);
  }
  std::string table() { return tableOf(evaluateRun(options_)); }
};

TEST_F(TruthOfADrive, ThatAgreesWithItsVelocitiesIsNotDoubted) {
  writePackets(10.2);  // 29 m and 29.6 m: 2 %, but not a meter
  const Evaluation evaluation = evaluateRun(options_);
  ASSERT_TRUE(evaluation.truth_check);
  EXPECT_NEAR(evaluation.truth_check->way_m, 29, 1e-6);
  EXPECT_NEAR(evaluation.truth_check->velocity_way_m, 29.58, 1e-5);
  EXPECT_FALSE(evaluation.truth_check->doubtful());
  EXPECT_THAT(tableOf(evaluation), Not(HasSubstr("doubt")));
}

TEST_F(TruthOfADrive, WhoseWayIsNotThatOfItsVelocitiesIsDoubted) {
  writePackets(10.6);
  EXPECT_THAT(table(), HasSubstr("the way is 29.0 m by positions and 30.7 m by velocities, 6.0 % apart"));
  EXPECT_THAT(jsonOf(evaluateRun(options_)), HasSubstr("\"doubtful\": true"));
  options_.truth = OxtsTimes::kVelocities;
  const Evaluation by_velocity = evaluateRun(options_);
  EXPECT_NEAR(by_velocity.final.camera->length_m, 30.74, 1e-5);
  EXPECT_NEAR(by_velocity.final.camera->rpe_m.mean, 0.06, 1e-6) << "the run went 1 m per frame";
  EXPECT_FALSE(by_velocity.truth_check);
  EXPECT_THAT(by_velocity.camera_source, HasSubstr("velocities"));
}

TEST_F(TruthOfADrive, ThatJumpsAsideIsDoubtedWhereItDoes) {
  writePackets(10);
  std::string poses;
  for (int i = 0; i < kFrames; ++i)
    poses += kittiLine(SE3(Eigen::Matrix3d::Identity(), {i < 17 ? 0 : 1.5, 0, static_cast<double>(i)})) + "\n";
  folder_.write("drive/poses.txt", poses);
  const Evaluation evaluation = evaluateRun(options_);
  EXPECT_TRUE(evaluation.truth_check->jumps());
  EXPECT_LE(evaluation.truth_check->step_from.value, 16);
  EXPECT_GE(evaluation.truth_check->step_to.value, 17);
  EXPECT_THAT(tableOf(evaluation), HasSubstr("they are 1.5 m apart"));
}

TEST_F(TruthOfADrive, OfAnotherFrameIsTold) {
  EXPECT_THAT(table(), Not(HasSubstr("doubt")));
  Eigen::Matrix3d world_body;
  world_body << 0, -1, 0, 0, 0, -1, 1, 0, 0;                        // x ahead, z up, as of an inertial unit
  const Eigen::Matrix3d turned = expSO3({std::numbers::pi, 0, 0});  // a quaternion read in another order
  for (const auto& [rotation, text] :
       {std::pair(world_body, "go ways 90 deg apart"), std::pair(turned, "go ways 180 deg apart")}) {
    std::string poses;
    for (int i = 0; i < kFrames; ++i) poses += kittiLine(SE3(rotation, {0, 0, static_cast<double>(i)})) + "\n";
    folder_.write("drive/poses.txt", poses);
    EXPECT_THAT(table(), HasSubstr(text));
  }
}

TEST(CourseDifference, IsThatOfTheMountingAndNoneOfPathsWithoutDirection) {
  std::vector<SE3> ahead, aside, round;
  for (int i = 0; i < 40; ++i) {
    ahead.push_back(i == 0 ? SE3() : ahead.back() * SE3(expSO3({0, 0.02, 0}), {0, 0, 0.7}));
    aside.push_back(ahead.back() * SE3(expSO3({0, 0.03, 0}), Eigen::Vector3d::Zero()));
    round.emplace_back(Eigen::Matrix3d::Identity(), Eigen::Vector3d(std::cos(0.3 * i), std::sin(0.3 * i), 0));
  }
  EXPECT_NEAR(courseDifference_deg(ahead, aside), 0.03 * 180 / std::numbers::pi, 1e-6);
  EXPECT_EQ(courseDifference_deg(ahead, round), 0);
  EXPECT_EQ(courseDifference_deg({}, {}), 0);
}

TEST_F(TruthOfADrive, IsMeasuredWithoutVelocitiesAndRefusedWhereTheseAreAskedFor) {
  EXPECT_FALSE(evaluateRun(options_).truth_check);
  options_.truth = OxtsTimes::kVelocities;
  EXPECT_THAT(messageOf<InputError>([&] { evaluateRun(options_); }), HasSubstr("--truth velocity needs oxts"));
  folder_.write("drive/oxts.txt", "49 8 100 0 0 0\n");
  EXPECT_THAT(messageOf<InputError>([&] { evaluateRun(options_); }), HasSubstr("one for each packet"));
  writePackets(10);
  std::filesystem::remove(folder_ / "drive/times.txt");
  EXPECT_THAT(messageOf<InputError>([&] { evaluateRun(options_); }), HasSubstr("times.txt"));
}

TEST(TruthCheck, RealDrivesWhoseTruthIsGoodAreNotDoubted) {
  for (const char* const name : {"kitti_tracking_0003", "kitti_tracking_0001"}) {
    if (!std::filesystem::exists(dataFolder() / name)) GTEST_SKIP() << dataFolder() / name << " is not there";
    const Sequence sequence = openSequence(dataFolder() / name);
    for (const OxtsTimes times : {OxtsTimes::kInterpolated, OxtsTimes::kUninterpolated}) {
      const auto check = checkTruth(sequence, *readCameraTruth(sequence, times));
      ASSERT_TRUE(check) << name;
      EXPECT_FALSE(check->doubtful()) << name;
      EXPECT_LT(std::abs(check->differencePercent()), 0.6) << name;
      EXPECT_LT(check->largest_step_m, 0.5) << name;
    }
  }
}

}  // namespace
}  // namespace motorcade::test
