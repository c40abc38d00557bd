#include <cmath>
#include <random>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "apps/evaluate/measures/evaluation.hpp"
#include "apps/evaluate/report/report.hpp"
#include "io/files/errors.hpp"
#include "io/images/image_file.hpp"
#include "io/layouts/open_sequence.hpp"
#include "io/results/run_folder.hpp"
#include "io/truth/trajectory.hpp"
#include "tests/apps/evaluate/evaluated_drive.hpp"
#include "tests/io/temporary_folder.hpp"
#include "tests/support/data_folder.hpp"

namespace motorcade {
namespace {

using namespace nlohmann::literals;
using test::EvaluateDrive;
using test::messageOf;
using testing::HasSubstr;

const std::filesystem::path kData = test::dataFolder();

/// Figures of VISO2-S by another program; they are printed with three or four digits.
struct Anchor {
  const char* drive;
  double ate_m, first_pose_m, end_percent, rpe_m, rpe_median_m, rpe_deg, rpe_median_deg;
};

class Anchors : public testing::TestWithParam<Anchor> {};

TEST_P(Anchors, MeasuresOfVisoAgreeWithPublishedOnes) {
  const Anchor& anchor = GetParam();
  if (!std::filesystem::exists(kData / anchor.drive)) GTEST_SKIP() << kData / anchor.drive << " is not there";
  const Sequence sequence = openSequence(kData / anchor.drive);
  const auto poses = readKittiPoses(kData / "viso2" / (std::string(anchor.drive) + ".txt"));
  const auto errors = evaluatePoses(poses, sequence).camera;
  ASSERT_TRUE(errors);
  constexpr double kRounding = 6e-4, kRoundingOfFour = 6e-5, kRoundingOfTwo = 6e-3;
  EXPECT_NEAR(errors->ate_m.rmse, anchor.ate_m, kRounding);
  EXPECT_NEAR(errors->ate_first_pose_m.rmse, anchor.first_pose_m, kRounding);
  EXPECT_NEAR(errors->end_percent, anchor.end_percent, kRoundingOfTwo);
  EXPECT_NEAR(errors->rpe_m.rmse, anchor.rpe_m, kRoundingOfFour);
  EXPECT_NEAR(errors->rpe_m.median, anchor.rpe_median_m, kRoundingOfFour);
  // The anchors take angles from the trace, which the few digits of some pose files blur; we take them from rotations
  // put back onto SO(3).
  EXPECT_NEAR(errors->rpe_deg.rmse, anchor.rpe_deg, 1e-4);
  EXPECT_NEAR(errors->rpe_deg.median, anchor.rpe_median_deg, 2.5e-3);
}

INSTANTIATE_TEST_SUITE_P(
    Viso2, Anchors,
    testing::Values(Anchor{"kitti_tracking_0003", 0.422, 1.695, 1.48, 0.0314, 0.0228, 0.0379, 0.0305},
                    Anchor{"kitti_odometry_04", 0.198, 0.517, 1.18, 0.0247, 0.0180, 0.0488, 0.0356},
                    Anchor{"kitti_odometry_06", 0.132, 0.407, 1.04, 0.0145, 0.0131, 0.0684, 0.0397},
                    Anchor{"rendered_street", 0.039, 0.069, 0.22, 0.0189, 0.0155, 0.0411, 0.0375}),
    [](const auto& instance) { return std::string(instance.param.drive); });

/// Figures of VISO2-S over segments, by a program of a hundred lines that was written for this test alone, from the
/// description of KITTI's benchmark; it takes angles from the trace.
struct SegmentAnchor {
  const char* drive;
  std::size_t segments;
  double translation_percent, rotation_deg_per_m, shortest_percent;
};

class SegmentAnchors : public testing::TestWithParam<SegmentAnchor> {};

TEST_P(SegmentAnchors, AgreeWithThoseOfAnotherProgram) {
  const SegmentAnchor& anchor = GetParam();
  if (!std::filesystem::exists(kData / anchor.drive)) GTEST_SKIP() << kData / anchor.drive << " is not there";
  const auto poses = readKittiPoses(kData / "viso2" / (std::string(anchor.drive) + ".txt"));
  const auto errors = evaluatePoses(poses, openSequence(kData / anchor.drive)).camera_segments;
  ASSERT_TRUE(errors);
  EXPECT_TRUE(errors->short_segments);
  EXPECT_EQ(errors->all.segments, anchor.segments);
  constexpr double kRounding = 1e-4, kFewDigitsOfTheTrace_deg = 2e-4;
  EXPECT_NEAR(errors->all.translation_percent, anchor.translation_percent, kRounding);
  EXPECT_NEAR(errors->all.rotation_deg_per_m, anchor.rotation_deg_per_m, kFewDigitsOfTheTrace_deg);
  EXPECT_NEAR(errors->by_length[0].translation_percent, anchor.shortest_percent, kRounding);
}

INSTANTIATE_TEST_SUITE_P(Viso2, SegmentAnchors,
                         testing::Values(SegmentAnchor{"kitti_tracking_0003", 91, 1.6632, 0.007796, 1.9253},
                                         SegmentAnchor{"kitti_tracking_0001", 15, 2.8757, 0.009226, 2.9628},
                                         SegmentAnchor{"kitti_odometry_04", 18, 1.2055, 0.010563, 1.3563},
                                         SegmentAnchor{"kitti_odometry_06", 15, 1.0930, 0.029510, 1.1232},
                                         SegmentAnchor{"rendered_street", 15, 0.2501, 0.005845, 0.3137}),
                         [](const auto& instance) { return std::string(instance.param.drive); });

TEST(UninterpolatedTruth, GivesTheLargerErrorsOfPublishedEvaluations) {
  if (!std::filesystem::exists(kData / "kitti_tracking_0003"))
    GTEST_SKIP() << kData / "kitti_tracking_0003"
                 << " is not there";
  const auto errors = evaluatePoses(readKittiPoses(kData / "viso2/kitti_tracking_0003.txt"),
                                    openSequence(kData / "kitti_tracking_0003"), OxtsTimes::kUninterpolated)
                          .camera;
  EXPECT_NEAR(errors->ate_m.rmse, 0.424, 6e-4);
  EXPECT_NEAR(errors->rpe_m.rmse, 0.0641, 6e-5);
  EXPECT_NEAR(errors->rpe_deg.rmse, 0.0389, 6e-5);
}

TEST(TrajectoryErrors, AreZeroForATrajectoryMovedAsAWholeAndKnownForADriftingOne) {
  std::vector<SE3> truth, moved, longer;
  const SE3 somewhere = SE3::exp((Vector6d() << 3, -2, 1, 0.1, 2, 0.3).finished());
  for (int i = 0; i < 20; ++i) {
    truth.push_back(SE3::exp((Vector6d() << 0, 0, i, 0, 0.02 * i, 0).finished()));
    moved.push_back(somewhere * truth.back());
    longer.push_back({truth.back().rotation(), 1.1 * truth.back().translation()});
  }
  const auto none = trajectoryErrors(moved, truth);
  EXPECT_NEAR(none->ate_m.rmse, 0, 1e-9);
  EXPECT_NEAR(none->ate_first_pose_m.rmse, 0, 1e-9);
  EXPECT_NEAR(none->are_deg.max, 0, 1e-6);
  const auto drift = trajectoryErrors(longer, truth);
  EXPECT_NEAR(drift->rpe_m.mean, 0.1, 0.01);  // a tenth of each step of about one meter
  EXPECT_NEAR(drift->end_percent, 10, 0.2);   // of a path that bends a little
  EXPECT_FALSE(trajectoryErrors({SE3()}, {SE3()}));
}

TEST_F(EvaluateDrive, APerfectRunHasNoErrors) {
  writeRun("run", 0, kFrames, [](int, FrameEstimate&) {});
  const Evaluation evaluation = evaluateRun(options_);
  EXPECT_NEAR(evaluation.final.camera->ate_m.rmse, 0, 1e-6);
  ASSERT_EQ(evaluation.final.objects.size(), 1u) << "the parked car is not asked for";
  const ObjectErrors& object = evaluation.final.objects[0];
  EXPECT_EQ(object.label, 7);
  EXPECT_EQ(object.followed_frames, kFrames);
  constexpr double kDigitsOfTheFiles = 1e-5;
  EXPECT_NEAR(object.trajectory->ate_m.rmse, 0, kDigitsOfTheFiles);
  EXPECT_NEAR(object.trajectory->ate_first_pose_m.rmse, 0, kDigitsOfTheFiles);
  EXPECT_NEAR(object.motion.me_m.max, 0, kDigitsOfTheFiles);
  EXPECT_NEAR(object.motion.speed_mps.max, 0, kDigitsOfTheFiles);
  EXPECT_DOUBLE_EQ(evaluation.final.detection.within_30m.recall(), 1);
  EXPECT_EQ(evaluation.final.detection.within_30m_from_fifth.labels, kFrames - 4);
  EXPECT_DOUBLE_EQ(evaluation.final.detection.mota, 1);
  EXPECT_NEAR(evaluation.final.image_within_30m.hota, 1, 1e-9);
  EXPECT_EQ(evaluation.online.first_within_30m.frames.max, 0);
  EXPECT_EQ(evaluation.final.detection.false_rows, 0);
  for (const KindEvaluation* kind : {&evaluation.online, &evaluation.final}) {
    EXPECT_DOUBLE_EQ(kind->covariances.camera.pose.coverage_95, 1);
    EXPECT_DOUBLE_EQ(kind->covariances.camera_pose.pose.coverage_95, 1);
    EXPECT_DOUBLE_EQ(kind->covariances.objects.pose.coverage_95, 1);
  }
}

TEST_F(EvaluateDrive, MissesSwitchesAndFalseRowsAreCounted) {
  writeRun("run", 0, kFrames, [](int i, FrameEstimate& estimate) {
    if (i < 6) estimate.objects.clear();
    if (i >= 20) estimate.objects = {lead(i, 4)};
    if (i == 10) estimate.objects[0].state = ObjectState::kPredicted;
    if (i == 11) estimate.objects[0].points = 2;
    if (i >= 25) {  // on the parked car, and on nothing
      estimate.objects.push_back(lead(i, 5));
      estimate.objects.back().T_world_body = SE3(Eigen::Matrix3d::Identity(), {-4, 1, 60});
      estimate.objects.push_back(lead(i, 6));
      estimate.objects.back().T_world_body = SE3(Eigen::Matrix3d::Identity(), {-30, 1, 60});
    }
  });
  const DetectionErrors errors = evaluateRun(options_).final.detection;
  EXPECT_EQ(errors.within_30m.found, kFrames - 8);
  EXPECT_EQ(errors.false_rows, 10);
  EXPECT_EQ(errors.false_rows_unlabeled, 5);
  using Frames = std::map<std::int64_t, std::vector<std::int64_t>>;
  EXPECT_EQ(errors.false_in, (Frames{{5, {25, 26, 27, 28, 29}}, {6, {25, 26, 27, 28, 29}}}));
  EXPECT_EQ(errors.missed_in, (Frames{{7, {0, 1, 2, 3, 4, 5, 10, 11}}}));
  EXPECT_EQ(errors.id_switches, 1);
  EXPECT_NEAR(errors.mota, 1 - (8 + 10 + 1) / 30.0, 1e-12);
}

TEST_F(EvaluateDrive, MotionErrorDoesNotDependOnTheCamerasDrift) {
  writeRun("run", 0, kFrames, [](int i, FrameEstimate& estimate) {
    const SE3 drift = SE3::exp((Vector6d() << 0.1 * i, 0, 0.3 * i, 0, 0.01 * i, 0).finished());
    estimate.objects[0].T_world_body = drift * estimate.objects[0].T_world_body;
    estimate.T_world_cam = drift * estimate.T_world_cam;
  });
  const Evaluation evaluation = evaluateRun(options_);
  EXPECT_GT(evaluation.final.camera->ate_first_pose_m.rmse, 1);
  // What remains is the drift from one frame to the next, as the object's motion is told in the earlier camera.
  EXPECT_NEAR(evaluation.final.motion.me_m.mean, 0.55, 0.2);
  EXPECT_EQ(evaluation.final.detection.within_30m.found, kFrames) << "matching is relative to the camera";
}

TEST_F(EvaluateDrive, PartOfASequenceIsMeasuredFromItsFirstFrame) {
  writeRun("run", 8, 20, [](int, FrameEstimate&) {});
  const Evaluation evaluation = evaluateRun(options_);
  EXPECT_EQ(evaluation.first_frame, 8);
  EXPECT_EQ(evaluation.final.frames, 12u);
  EXPECT_NEAR(evaluation.final.camera->ate_first_pose_m.rmse, 0, 1e-6);
  EXPECT_NEAR(evaluation.final.motion.me_m.max, 0, 1e-5);
  EXPECT_DOUBLE_EQ(evaluation.final.detection.within_30m.recall(), 1);
}

TEST_F(EvaluateDrive, BaselinesGiveRelativeErrors) {
  const auto bend = [](double size) {
    return [size](int i, FrameEstimate& estimate) {
      estimate.T_world_cam = SE3(Eigen::Matrix3d::Identity(), {size * std::sin(i * 0.5), 0, 0}) * estimate.T_world_cam;
      estimate.objects[0].T_world_body =
          SE3(Eigen::Matrix3d::Identity(), {size * std::sin(i * 0.5), 0, 0}) * estimate.objects[0].T_world_body;
    };
  };
  writeRun("run", 0, kFrames, bend(0.1));
  writeRun("filter", 0, kFrames, bend(0.2));
  options_.baseline = folder_ / "filter/camera_final.txt";
  options_.baseline_run = folder_ / "filter";
  const Evaluation evaluation = evaluateRun(options_);
  EXPECT_NEAR(evaluation.camera_against_baseline->relative(), 0.5, 0.01);  // half the bend
  ASSERT_EQ(evaluation.objects_against_baseline->objects.size(), 1U);
  const ComparedObject& object = evaluation.objects_against_baseline->objects[0];
  EXPECT_EQ(object.label, 7);
  EXPECT_NEAR(object.relativeError(static_cast<std::size_t>(PositionKind::kAligned)), 0.5, 0.01);
  EXPECT_NEAR(object.relativeError(static_cast<std::size_t>(PositionKind::kWorldOffsetRemoved)), 0.5, 0.01);
  folder_.write("short.txt", kittiLine(SE3()) + "\n");
  options_.baseline = folder_ / "short.txt";
  EXPECT_THAT(messageOf<InputError>([&] { evaluateRun(options_); }), HasSubstr("short.txt"));
}

TEST_F(EvaluateDrive, ABaselineMayBeATrajectoryWithTimes) {
  writeRun("run", 4, kFrames, [](int, FrameEstimate&) {});
  std::string tum = "# timestamp tx ty tz qx qy qz qw\n";
  for (int i = 0; i < kFrames; ++i) {
    const SE3 bent(Eigen::Matrix3d::Identity(), {0.2 * std::sin(i * 0.5), 0, 0});
    tum += tumLine({i * 100'000'000LL}, bent * camera(i)) + "\n";
  }
  options_.baseline = folder_.write("baseline.tum", tum);
  const auto against = evaluateRun(options_).camera_against_baseline;
  ASSERT_TRUE(against);
  EXPECT_NEAR(against->baseline_m, 0.14, 0.02) << "a sine of 0.2 m";
  EXPECT_NEAR(against->ours_m, 0, 1e-6);
}

TEST_F(EvaluateDrive, KilledRunsAndRunsWithoutLabelsAreMeasured) {
  writeRun("run", 0, kFrames, [](int, FrameEstimate&) {});
  std::filesystem::remove(folder_ / "run/summary.json");
  std::filesystem::remove(folder_ / "run/covariances.csv");
  folder_.write("run/camera_final.txt", "");
  folder_.write("run/objects_final.csv", "");
  Evaluation evaluation = evaluateRun(options_);
  EXPECT_FALSE(evaluation.complete);
  EXPECT_EQ(evaluation.final.frames, static_cast<std::size_t>(kFrames));
  EXPECT_EQ(evaluation.finals_recovered, static_cast<std::size_t>(kFrames));
  EXPECT_THAT(tableOf(evaluation), HasSubstr("online estimates"));
  EXPECT_EQ(evaluation.online.frames, static_cast<std::size_t>(kFrames));
  std::filesystem::remove(folder_ / "drive/label_02.txt");
  evaluation = evaluateRun(options_);
  EXPECT_THAT(tableOf(evaluation), testing::Not(HasSubstr("recall")));
}

TEST_F(EvaluateDrive, MasksAreComparedWhereTheSequenceHasInstances) {
  writeRun("run", 0, kFrames, [](int, FrameEstimate&) {});
  constexpr int kLabelValue = 8, kTrackValue = 4;
  Gray16Image image{64, 32, std::vector<std::uint16_t>(64 * 32)};
  for (const auto& [name, value] : {std::pair("drive/instance", kLabelValue), std::pair("run/masks", kTrackValue)}) {
    std::filesystem::create_directories(folder_ / name);
    image.pixels[700] = static_cast<std::uint16_t>(value);
    writePng16(folder_ / name / "000002.png", image);
  }
  const Evaluation evaluation = evaluateRun(options_);
  ASSERT_TRUE(evaluation.masks);
  EXPECT_EQ(evaluation.masks->within_30m.rows_with_mask, 1);
  EXPECT_EQ(evaluation.masks->within_30m.iou, 1);
  EXPECT_THAT(tableOf(evaluation), HasSubstr("boundary error"));
  const auto json = nlohmann::json::parse(jsonOf(evaluation));
  EXPECT_EQ(json.at("/masks/within_30m/boundary_px/count"_json_pointer), 1);
}

TEST_F(EvaluateDrive, ASequenceWithoutTruthIsRefused) {
  writeRun("run", 0, 3, [](int, FrameEstimate&) {});
  std::filesystem::remove(folder_ / "drive/poses.txt");
  EXPECT_THAT(messageOf<InputError>([&] { evaluateRun(options_); }), HasSubstr("no ground truth"));
}

}  // namespace
}  // namespace motorcade
