#include "backend/window/continuous_poses.hpp"

#include <gtest/gtest.h>

#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::IsNear;

SE3 at(double x_m, double y_m = 0) { return {Eigen::Matrix3d::Identity(), {x_m, y_m, 0}}; }

/// A camera and an object that move by 1 m in each frame, at 10 Hz; all estimates are shifted at once in frame 10.
struct Drive {
  static constexpr int kShifted = 10, kMotionFrames = 5;
  inline static const Matrix6d kCovariance = 1e-4 * Matrix6d::Identity();
  double shift_m = 0.5;
  int unseen = 0;  // frames before the shift

  SE3 camera(int frame, int now) const { return at(frame, now < kShifted ? 0 : shift_m); }
  SE3 object(int frame, int now) const { return at(frame + 8, now < kShifted ? 0 : shift_m); }

  std::vector<FrameEstimate> published(double correction_s) const {
    ContinuousPoses continuous(correction_s);
    std::vector<FrameEstimate> all;
    for (int now = 0; now < 40; ++now) {
      FrameEstimate online{.head = {.frame = {now}, .stamp = {100'000'000 * static_cast<std::int64_t>(now)}},
                           .T_world_cam = camera(now, now),
                           .camera_covariances = {},
                           .objects = {}};
      if (now < kShifted && now >= kShifted - unseen) online.head.status = FrameStatus::kLost;
      ObjectEstimate& seen = online.objects.emplace_back();
      seen.track = TrackId{3};
      seen.T_world_body = object(now, now);
      seen.covariance = online.camera_covariances.motion = online.camera_covariances.pose = kCovariance;
      continuous(online,
                 {.camera = [&](FrameId frame) { return camera(static_cast<int>(frame.value), now); },
                  .object = [&](TrackId, FrameId frame) { return object(static_cast<int>(frame.value), now); }},
                 now >= kMotionFrames ? std::optional(FrameId{now - kMotionFrames}) : std::nullopt);
      all.push_back(online);
    }
    return all;
  }
};

TEST(ContinuousPoses, AddCorrectionsGradually) {
  const auto published = Drive{}.published(0.5);
  double largest = 0;
  for (std::size_t i = 1; i < published.size(); ++i) {
    const Eigen::Vector3d step = published[i].T_world_cam.translation() - published[i - 1].T_world_cam.translation();
    EXPECT_NEAR(step.x(), 1, 1e-9);
    largest = std::max(largest, std::abs(step.y()));
  }
  EXPECT_LT(largest, 0.3);
  EXPECT_NEAR(published.back().T_world_cam.translation().y(), 0.5, 1e-3);
}

TEST(ContinuousPoses, ObjectsComeToWhereTheyAreSeenFromTheCamera) {
  const auto published = Drive{}.published(0.5);
  const FrameEstimate& last = published.back();
  EXPECT_THAT((last.T_world_cam.inverse() * last.objects[0].T_world_body).translation(),
              IsNear(Eigen::Vector3d(8, 0, 0), 0.01));
  for (std::size_t i = 1; i < published.size(); ++i)
    EXPECT_LT(std::abs((published[i].objects[0].T_world_body.translation() -
                        published[i - 1].objects[0].T_world_body.translation())
                           .y()),
              0.2);
}

TEST(ContinuousPoses, TakeBackAGuessAtOnce) {
  const Drive drive{.unseen = 2};
  const auto published = drive.published(0.5);
  for (int frame = Drive::kShifted; frame < 40; ++frame) {
    const FrameEstimate& now = published[static_cast<std::size_t>(frame)];
    EXPECT_THAT(now.T_world_cam.translation(), IsNear(drive.camera(frame, frame).translation(), 1e-9));
    EXPECT_THAT(now.objects[0].T_world_body.translation(), IsNear(drive.object(frame, frame).translation(), 1e-9));
  }
  EXPECT_NEAR((*published[Drive::kShifted].camera_covariances.pose)(1, 1), 1e-4, 1e-6) << "nothing is left to add";
}

/// A pose's error over its deviation, along y.
double sigmas(double error_m, const std::optional<Matrix6d>& covariance) {
  return std::abs(error_m) / std::sqrt((*covariance)(1, 1));
}

TEST(ContinuousPoses, CovariancesContainWhatIsStillToBeAdded) {
  const Drive drive;
  const auto published = drive.published(0.5);
  const auto y = [&](std::size_t frame) { return published[frame].T_world_cam.translation().y(); };
  for (std::size_t frame = Drive::kShifted; frame < published.size(); ++frame) {
    const FrameEstimate& now = published[frame];
    EXPECT_LE(sigmas(y(frame) - drive.shift_m, now.camera_covariances.pose), 1) << frame;
    const double seen_m = now.objects[0].T_world_body.translation().y() - y(frame);
    EXPECT_LE(sigmas(seen_m, now.objects[0].covariance), 1) << frame;
    EXPECT_LE(sigmas(y(frame) - y(frame - Drive::kMotionFrames), now.camera_covariances.motion), 1) << frame;
  }
  EXPECT_GT(sigmas(y(Drive::kShifted) - drive.shift_m, Drive::kCovariance), 20) << "there is something to be added";
  EXPECT_NEAR((*published.back().camera_covariances.pose)(1, 1), 1e-4, 1e-6);
  EXPECT_NEAR((*published.back().camera_covariances.motion)(1, 1), 1e-4, 1e-6);
}

TEST(ContinuousPoses, WithoutATimeAreThoseEstimated) {
  const auto published = Drive{}.published(0);
  for (const FrameEstimate& estimate : published) {
    const int now = static_cast<int>(estimate.head.frame.value);
    EXPECT_THAT(estimate.T_world_cam.translation(), IsNear(Drive{}.camera(now, now).translation(), 1e-12));
    EXPECT_THAT(estimate.objects[0].T_world_body.translation(), IsNear(Drive{}.object(now, now).translation(), 1e-12));
  }
}

}  // namespace
}  // namespace motorcade
