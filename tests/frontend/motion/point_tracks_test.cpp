#include "frontend/motion/point_tracks.hpp"

#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "tests/frontend/texture.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::kRig;

const Eigen::Vector3d kPoint(2, 0.5, 20);  // in the first camera
constexpr PointId kA{4}, kB{9};

/// A camera that drives ahead by 1 m a frame, and the results of circular matching for the points of optical flow.
class DriveAhead {
 public:
  explicit DriveAhead(const PointTracks::Params& params = {}) : tracks(params, kRig) {}

  OpticalFlow flow(const std::vector<PointId>& points) const {
    OpticalFlow flow;
    flow.features = features_;
    for (const PointId point : points) flow.observations.push_back({.point = point});
    return flow;
  }
  void addFrame() {
    trail.add({frame * 100'000'000}, frame ? SE3(Eigen::Matrix3d::Identity(), {0, 0, 1}) : SE3{});
    ++frame;
  }
  /// Shows checks to the camera from now on, whose patches are found everywhere.
  void showChecks() {
    features_ = imageOf([](double u, double v) { return 128 + 60 * std::sin(u) * std::sin(v); });
  }
  int ambiguousPoints() const {
    int count = 0;
    for (const PointTrack& track : tracks.observedNow()) count += track.ambiguity > 0;
    return count;
  }
  /// Point A is at rest, B and those after it drive aside; `missing` was not found in the right image.
  void observe(const std::vector<PointId>& points, std::optional<PointId> missing = {}) {
    addFrame();
    std::vector<std::optional<StereoObservation>> observed;
    for (const PointId point : points) {
      const Eigen::Vector3d p = p_cam(point);
      observed.emplace_back(StereoObservation{kRig.project(p)->cast<float>(), Eigen::Vector3f::Constant(0.3F)});
      if (point == missing) observed.back().reset();
    }
    tracks.update(flow(points), observed, trail);
  }
  Eigen::Vector3d p_cam(PointId point) const {
    const double travelled_m = frame - 1;
    return kPoint + Eigen::Vector3d(point < kB ? 0 : -0.5 * travelled_m, 0, -travelled_m);
  }
  std::vector<PointId> observedNow() const {
    std::vector<PointId> points;
    for (const PointTrack& track : tracks.observedNow()) points.push_back(track.point);
    return points;
  }
  std::optional<KnownPoint> known(PointId point) const { return tracks.known(flow({point}), trail)[0]; }

  PointTracks tracks;
  CameraTrail trail;
  int frame = 0;

 private:
  template <class Gray>
  static FeaturesPtr imageOf(const Gray& gray) {
    auto features = std::make_shared<Features>();
    features->left.levels.push_back(test::render(kRig.width_px, kRig.height_px, gray));
    return features;
  }
  FeaturesPtr features_ = imageOf([](double, double) { return 128.0; });
};

TEST(PointTracks, APointAtRestIsKnownMoreExactlyWithEveryFrame) {
  DriveAhead drive;
  EXPECT_FALSE(drive.known(kA));
  double before_m2 = 1e9;
  for (int k = 0; k < 5; ++k) {
    drive.observe({kA, kB});
    const auto known = drive.known(kA);
    ASSERT_TRUE(known);
    EXPECT_THAT(known->p_cam, test::IsNear(drive.p_cam(kA), 1e-3));  // pixels are kept as floats
    EXPECT_NEAR(known->disparity_px, kRig.project(drive.p_cam(kA))->z(), 1e-4);
    EXPECT_LT(known->covariance(2, 2), before_m2);
    before_m2 = known->covariance(2, 2);
  }
  EXPECT_FALSE(drive.known({5}));
}

TEST(PointTracks, TellsMotionFromRest) {
  DriveAhead drive;
  for (int k = 0; k < 5; ++k) drive.observe({kA, kB});
  for (const PointTrack& track : drive.tracks.observedNow()) {
    ASSERT_TRUE(track.flow);
    EXPECT_EQ(track.p_static_cam.has_value(), track.point == kA);
    EXPECT_NEAR(track.flow->velocity_mps.x(), track.point == kA ? 0 : -5, 0.5);  // the velocity's prior pulls to zero
  }
}

TEST(PointTracks, ATrackThatMissesItsDisparityForLongEnds) {
  PointTracks::Params params;
  params.max_missed_frames = 2;
  DriveAhead drive(params);
  drive.observe({kA, kB});
  for (int missed = 1; missed <= 3; ++missed) {
    EXPECT_TRUE(drive.known(kA));
    drive.observe({kA, kB}, kA);
    EXPECT_EQ(drive.observedNow(), std::vector{kB});
  }
  EXPECT_FALSE(drive.known(kA));
  EXPECT_TRUE(drive.known(kB));
}

TEST(PointTracks, ATrackEndsWhenOpticalFlowNoLongerFollowsItsPoint) {
  DriveAhead drive;
  drive.observe({kA, kB});
  drive.observe({kB});
  EXPECT_FALSE(drive.known(kA));
  drive.observe({kA, kB});
  EXPECT_EQ(drive.observedNow(), (std::vector{kA, kB}));
  EXPECT_EQ(drive.tracks.observedNow().front().get().count, 1);
}

TEST(PointTracks, NothingIsKnownOfAPointThatTheTrailHasForgotten) {
  DriveAhead drive;
  drive.observe({kA});
  for (int k = 0; k <= CameraTrail::kCapacity; ++k) drive.addFrame();  // short of the point
  EXPECT_FALSE(drive.known(kA));
  drive.observe({kA});
  EXPECT_TRUE(drive.known(kA));
}

TEST(PointTracks, LabelsComeBackAndSayWhatIsAtRest) {
  DriveAhead drive;
  for (int k = 0; k < 4; ++k) drive.observe({kA, kB});
  EXPECT_EQ(drive.tracks.atRestSince(1).size(), 1U);
  EXPECT_TRUE(drive.tracks.atRestSince(-1).empty());
  std::vector<ScenePoint> points(2);
  points[0].label = PointLabel::kMoving;
  drive.tracks.setLabels(points);
  EXPECT_TRUE(drive.known(kA)->label == PointLabel::kMoving);
  EXPECT_FALSE(drive.known(kB)->label == PointLabel::kMoving);
  EXPECT_TRUE(drive.tracks.atRestSince(1).empty());
}

TEST(PointTracks, AllDisparitiesFollowTheOffset) {
  DriveAhead drive;
  drive.observe({kA});
  drive.observe({kA});
  const double before_px = drive.known(kA)->disparity_px;
  drive.tracks.shiftDisparities(0.5F);
  EXPECT_NEAR(drive.known(kA)->disparity_px, before_px + 0.5, 1e-5);
  const auto observed = drive.tracks.observedNow();
  EXPECT_NEAR(observed.front().get().oldest().uvd_px.z(), kRig.project(kPoint)->z() + 0.5, 1e-4);
}

TEST(PointTracks, TrustedPointsAreCheckedForAmbiguousTextureInTurn) {
  const std::vector<PointId> points{kB, {10}, {11}, {12}};
  DriveAhead drive, young;
  for (int k = 0; k < 6; ++k) drive.observe(points);
  EXPECT_EQ(drive.ambiguousPoints(), 0);
  drive.showChecks();
  drive.observe(points);  // of the pair of images, the first one has no texture
  EXPECT_EQ(drive.ambiguousPoints(), 0);
  for (int checked = 1; checked <= 4; ++checked) {
    drive.observe(points);
    EXPECT_EQ(drive.ambiguousPoints(), checked);
  }
  young.showChecks();
  for (int k = 0; k < 4; ++k) young.observe(points);
  EXPECT_EQ(young.ambiguousPoints(), 4);  // before they are trusted: all at once
}

}  // namespace
}  // namespace motorcade
