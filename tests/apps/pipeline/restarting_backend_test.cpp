#include "apps/pipeline/restarting_backend.hpp"

#include <memory>
#include <set>
#include <stdexcept>
#include <vector>

#include <gmock/gmock.h>

#include "tests/apps/pipeline/toy_stages.hpp"

namespace motorcade {
namespace {

using testing::ElementsAre;

/// Chains the odometry from its own first frame on, keeps two frames, and fails in some.
class ToyBackend final : public Backend {
 public:
  explicit ToyBackend(std::set<std::int64_t> fails) : fails_(std::move(fails)) {}

  EstimatesPtr operator()(const FrameMeasurementsPtr& measurements) override {
    if (fails_.contains(measurements->head.frame.value)) throw std::runtime_error("toy trouble");
    Estimates result;
    result.online.head.frame = measurements->head.frame;
    if (begun_) T_world_cam_ = T_world_cam_ * measurements->odometry.T_previous_now;
    begun_ = true;
    result.online.T_world_cam = T_world_cam_;
    result.online.camera_covariances = {.motion = Matrix6d::Identity(), .pose = Matrix6d::Identity()};
    result.online.objects.resize(1);
    result.online.objects[0].T_world_body = T_world_cam_;
    result.online.objects[0].velocity_world_mps = T_world_cam_.rotation().col(2);
    window_.push_back(result.online);
    if (window_.size() > 2) {
      result.settled = result.finals = {window_.front()};
      window_.erase(window_.begin());
    }
    return std::make_shared<const Estimates>(result);
  }
  std::vector<FrameEstimate> finish() override { return window_; }

 private:
  std::set<std::int64_t> fails_;
  bool begun_ = false;
  SE3 T_world_cam_;
  std::vector<FrameEstimate> window_;
};

/// Measurements on a circle: each frame turns, so that a world that is not that of the first frame shows.
FrameMeasurementsPtr measurementsOf(std::int64_t frame) {
  FrameMeasurements measurements;
  measurements.head.frame = {frame};
  measurements.odometry.T_previous_now = SE3(expSO3({0, 0.1, 0}), {0, 0, 1});
  return std::make_shared<const FrameMeasurements>(measurements);
}

struct ToyRun {
  std::vector<FrameEstimate> online, settled, finals;
};

ToyRun driveFailing(const std::set<std::int64_t>& fails) {
  RestartingBackend backend([&] { return std::make_unique<ToyBackend>(fails); });
  ToyRun result;
  for (std::int64_t frame = 0; frame < 10; ++frame) {
    try {
      const EstimatesPtr estimates = backend(measurementsOf(frame));
      result.online.push_back(estimates->online);
      result.settled.insert(result.settled.end(), estimates->settled.begin(), estimates->settled.end());
      result.finals.insert(result.finals.end(), estimates->finals.begin(), estimates->finals.end());
    } catch (const std::runtime_error&) {
      EXPECT_TRUE(fails.contains(frame));
    }
  }
  const auto last = backend.finish();
  result.finals.insert(result.finals.end(), last.begin(), last.end());
  return result;
}

void expectOnTheSameCircle(const std::vector<FrameEstimate>& estimates, const ToyRun& undisturbed) {
  for (const FrameEstimate& estimate : estimates) {
    const FrameEstimate& expected = undisturbed.online[static_cast<std::size_t>(estimate.head.frame.value)];
    EXPECT_TRUE(estimate.T_world_cam.translation().isApprox(expected.T_world_cam.translation(), 1e-9) ||
                estimate.head.frame.value == 0);
    EXPECT_TRUE(estimate.T_world_cam.rotation().isApprox(expected.T_world_cam.rotation(), 1e-9));
    EXPECT_TRUE(estimate.objects[0].T_world_body.rotation().isApprox(expected.T_world_cam.rotation(), 1e-9));
    EXPECT_TRUE(estimate.objects[0].velocity_world_mps.isApprox(expected.objects[0].velocity_world_mps, 1e-9));
  }
}

TEST(RestartingBackend, GoesOnInTheSameWorldAfterFramesThatFailed) {
  const ToyRun undisturbed = driveFailing({}), disturbed = driveFailing({3, 6, 7});
  EXPECT_THAT(idsOf(disturbed.online), ElementsAre(0, 1, 2, 4, 5, 8, 9));
  expectOnTheSameCircle(disturbed.online, undisturbed);
  expectOnTheSameCircle(disturbed.settled, undisturbed);
}

/// A pose's covariance is relative to a start that went with the old back-end.
TEST(RestartingBackend, TellsNoCovarianceOfAPoseWhoseStartIsGone) {
  for (const FrameEstimate& estimate : driveFailing({3}).online) {
    EXPECT_EQ(estimate.camera_covariances.pose.has_value(), estimate.head.frame.value < 3);
    EXPECT_TRUE(estimate.camera_covariances.motion);
  }
}

TEST(RestartingBackend, GivesEachFrameThatDidNotFailOneFinalEstimate) {
  const ToyRun undisturbed = driveFailing({});
  EXPECT_EQ(idsOf(undisturbed.finals), numbersTo(10));
  const ToyRun disturbed = driveFailing({3, 6, 7, 9});
  EXPECT_THAT(idsOf(disturbed.finals), ElementsAre(0, 1, 2, 4, 5, 8));
  expectOnTheSameCircle(disturbed.finals, undisturbed);
  EXPECT_THAT(idsOf(driveFailing({0}).finals), ElementsAre(1, 2, 3, 4, 5, 6, 7, 8, 9));
}

}  // namespace
}  // namespace motorcade
