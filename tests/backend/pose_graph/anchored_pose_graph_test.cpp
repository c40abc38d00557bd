#include "backend/pose_graph/anchored_pose_graph.hpp"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "backend/pose_graph/pose_graph_backend.hpp"
#include "tests/backend/simulated_drive.hpp"
#include "tests/support/matchers.hpp"

/// Drives with measurements that are broken, or say too little: the objects concerned go, the camera goes on.
namespace motorcade {
namespace {

using test::IsNearPose;
using test::SimulatedDrive;
using testing::AllOf;
using testing::Contains;
using testing::Each;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

constexpr int kGraphFrames = 30;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kSame = 1e-8;  // of converged systems
const SE3 kNoPose(Eigen::Matrix3d::Identity(), {kNan, 0, 0});

/// Drives the frames, each changed by `change`, in a graph. Returns the sentences of each frame.
template <class Change>
std::vector<std::vector<std::string>> drive(AnchoredPoseGraph& graph, const Change& change) {
  SimulatedDrive drive(8, {});
  std::vector<std::vector<std::string>> problems;
  for (int frame = 0; frame < kGraphFrames; ++frame) {
    FrameMeasurements measurements = *drive.measure(frame);
    change(frame, measurements);
    graph.add(measurements);
    problems.push_back(graph.problems());
  }
  return problems;
}

void expectSameCamera(const AnchoredPoseGraph& graph, const AnchoredPoseGraph& expected) {
  ASSERT_EQ(graph.frames().size(), expected.frames().size());
  for (const auto& [frame, camera] : expected.frames())
    EXPECT_THAT(graph.solver().pose(graph.frames().at(frame).x), IsNearPose(expected.solver().pose(camera.x), kSame))
        << "frame " << frame.value;
}

/// Anchors have no prior.
PoseGraphParams withoutAnchors() {
  PoseGraphParams params;
  params.anchor_sigma_m = params.anchor_sigma_rad = std::numeric_limits<double>::infinity();
  params.use_object_encounter = false;
  params.mismatch_tolerance = params.jacobian_drift_sigmas = params.substitution_tolerance = 0;
  return params;
}

TEST(AnchoredPoseGraph, AnObjectWhoseAnchorNothingConstrainsIsDroppedByName) {
  PoseGraphParams params = withoutAnchors();
  params.use_camera_encounter = false;
  AnchoredPoseGraph graph(params), camera_alone(params);
  const auto problems = drive(graph, [](int, FrameMeasurements&) {});
  drive(camera_alone, [](int, FrameMeasurements& m) { m.objects.clear(); });
  EXPECT_THAT(
      problems[0],
      Contains(AllOf(StartsWith("object 100 is dropped: anchor of object 100 is not constrained in any direction"),
                     HasSubstr("its 1 factor touches it alone"))));
  for (const auto& [id, track] : graph.tracks()) EXPECT_FALSE(track.shared.valid());
  EXPECT_EQ(graph.solver().counters().variables, kGraphFrames);
  expectSameCamera(graph, camera_alone);
}

TEST(AnchoredPoseGraph, TheOtherObjectsStayAsTheyAreWithoutTheDroppedOne) {
  AnchoredPoseGraph graph(withoutAnchors()), without(withoutAnchors());
  const auto isBroken = [](const ObjectObservation& seen) { return seen.track == SimulatedDrive::track(1); };
  const auto problems = drive(graph, [&](int, FrameMeasurements& m) {
    for (auto& seen : m.objects)
      if (isBroken(seen)) seen.encounter_covariance.setConstant(kNan);
  });
  drive(without, [&](int, FrameMeasurements& m) { std::erase_if(m.objects, isBroken); });
  graph.converge();
  without.converge();
  EXPECT_THAT(problems[0],
              Contains("object 101, frame 0: its pose, whose covariance is not positive definite, is left out"));
  EXPECT_THAT(problems[0], Contains(StartsWith("object 101 is dropped: anchor of object 101 is not constrained")));
  for (const auto& of_frame : problems) EXPECT_THAT(of_frame, Each(StartsWith("object 101")));
  expectSameCamera(graph, without);
  for (const auto& [id, track] : without.tracks())
    for (const auto& [frame, record] : track.records)
      EXPECT_THAT(graph.objectPose(graph.tracks().at(id), frame), IsNearPose(without.objectPose(track, frame), kSame));
}

TEST(AnchoredPoseGraph, AnObjectStartsAnewWhenItIsSeenAgain) {
  AnchoredPoseGraph graph(withoutAnchors());
  const auto problems = drive(graph, [](int frame, FrameMeasurements& m) {
    if (frame >= 5) return;
    for (auto& seen : m.objects) seen.encounter_covariance.setConstant(kNan);
  });
  EXPECT_THAT(problems[4], Contains(StartsWith("object 100 is dropped")));
  for (int frame = 5; frame < kGraphFrames; ++frame) EXPECT_THAT(problems[frame], IsEmpty());
  const auto& track = graph.tracks().at(SimulatedDrive::track(0));
  EXPECT_TRUE(track.shared.valid());
  constexpr double kDriftAndNoise = 2;
  EXPECT_THAT(graph.objectPose(track, {kGraphFrames - 1}),
              IsNearPose(SimulatedDrive(8, {}).object(0, kGraphFrames - 1), kDriftAndNoise));
}

TEST(AnchoredPoseGraph, EveryMeasurementThatIsNoNumberIsNamed) {
  AnchoredPoseGraph graph(PoseGraphParams{});
  const auto problems = drive(graph, [](int frame, FrameMeasurements& m) {
    auto& seen = m.objects.front();
    if (frame == 5) seen.T_cam_body = kNoPose;
    if (frame == 6) seen.encounter_covariance.setZero();
    if (frame == 7) seen.motion->covariance.setConstant(kNan);
    if (frame == 8) seen.motion->T_before_now = kNoPose;
    if (frame == 9) m.odometry.T_previous_now = kNoPose;
    if (frame == 10) m.odometry.covariance.setZero();
    // Numbers, if not good ones: the losses and the conditions cope with them.
    if (frame == 11) seen.T_cam_body = SE3(Eigen::Matrix3d::Identity(), {1e200, 0, 0});
    if (frame == 12) seen.encounter_covariance *= 1e-300;
  });
  EXPECT_THAT(problems[5], Contains("object 100, frame 5: its pose, which is not finite, is left out"));
  EXPECT_THAT(problems[6],
              Contains("object 100, frame 6: its pose, whose covariance is not positive definite, is left out"));
  EXPECT_THAT(problems[7],
              Contains("object 100, frame 7: its motion, whose covariance is not positive definite, is left out"));
  EXPECT_THAT(problems[8],
              Contains(StartsWith(
                  "a factor on pose of object 100 in frame 7 and pose of object 100 in frame 8 is not finite")));
  EXPECT_THAT(problems[9],
              Contains(StartsWith("the camera's motion or its covariance is unusable: taken as standing still")));
  EXPECT_THAT(problems[10],
              Contains(StartsWith("the camera's motion or its covariance is unusable: taken as measured")));
  for (const std::size_t frame : {0U, 1U, 2U, 3U, 4U, 13U, 14U, 20U})
    EXPECT_THAT(problems[frame], IsEmpty()) << "frame " << frame;
  for (const auto& [frame, camera] : graph.frames())
    EXPECT_TRUE(graph.solver().pose(camera.x).translation().allFinite()) << "frame " << frame.value;
  EXPECT_TRUE(std::isfinite(graph.solver().counters().chi2));
}

TEST(AnchoredPoseGraph, SaysNothingOfGoodDrives) {
  for (int switches = 0; switches < 16; ++switches) {
    PoseGraphParams params;
    params.use_motion = (switches & 1) != 0;
    params.use_camera_encounter = (switches & 4) != 0;
    params.use_object_encounter = (switches & 8) != 0;
    AnchoredPoseGraph graph(params, {.use_smoothness = (switches & 2) != 0});
    EXPECT_THAT(drive(graph, [](int, FrameMeasurements&) {}), Each(IsEmpty())) << "switches " << switches;
    graph.converge();
    EXPECT_THAT(graph.problems(), IsEmpty());
  }
}

TEST(AnchoredPoseGraph, TheSmootherPassesOnWhatWentWrong) {
  PoseGraphSmoother smoother({});
  SimulatedDrive drive(8, {});
  FrameMeasurements broken = *drive.measure(0);
  broken.objects.front().T_cam_body = kNoPose;
  const auto estimates = smoother(std::make_shared<const FrameMeasurements>(broken));
  EXPECT_THAT(estimates->problems, testing::ElementsAre(HasSubstr("object 100, frame 0")));
  EXPECT_THAT(smoother(drive.measure(1))->problems, IsEmpty());
}

}  // namespace
}  // namespace motorcade
