#include <cmath>
#include <cstdint>
#include <map>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "frontend/tracking/object_tracker.hpp"
#include "tests/frontend/tracking/labelled_street.hpp"
#include "tests/frontend/tracking/textured_board.hpp"

namespace motorcade {
namespace {

using test::kRig;
using test::TexturedBoard;

/// Two people who walk to the right before a camera at rest, in images; the second one is 5 m farther off. A component
/// of one point spawns a person, whom patches then follow.
class Sidewalk {
 public:
  struct Seen {
    std::int64_t point;
    int person;
    PointLabel label = PointLabel::kUnknown;
    double wrong_mps = 0;  // of the component's velocity, away from the camera
  };
  /// One frame, in which each of these points makes a component.
  void walk(const std::vector<Seen>& components) {
    auto scene = std::make_shared<SceneMotion>();
    const int frame = next_++;
    scene->head.frame = {frame};
    scene->head.stamp = {static_cast<std::int64_t>(1e9 * kDt_s) * frame};
    scene->features = seen(frame);
    for (const Seen& point : components) {
      MotionComponent& component = scene->components.emplace_back();
      component.points = {static_cast<int>(scene->points.size())};
      component.label = point.label;
      component.centroid_cam = add(point, frame, *scene);
      component.velocity_mps = {kWalk_mps, 0, point.wrong_mps};
      component.velocity_covariance = 0.01 * Eigen::Matrix3d::Identity();
    }
    const auto measured = tracker_(scene);
    for (const ObjectObservation& o : measured->objects) reported_[o.track].push_back(o);
  }
  void walkOn(int frames) {
    for (int i = 0; i < frames; ++i) walk({});
  }
  /// All observations by track.
  const std::map<TrackId, std::vector<ObjectObservation>>& reported() const { return reported_; }
  static SE3 placeOf(int person, std::int64_t frame) {
    const double way_m = kDt_s * kWalk_mps * static_cast<double>(frame);
    return person == 0 ? TexturedBoard::standingAt(-3 + way_m, 9) : TexturedBoard::standingAt(-1 + way_m, 14);
  }

 private:
  static constexpr double kDt_s = 0.1, kWalk_mps = 1.4;

  static Eigen::Vector3d add(const Seen& seen, int frame, SceneMotion& scene) {
    Eigen::Vector3d p_cam = placeOf(seen.person, frame) * Eigen::Vector3d(0, 0.05, -0.2);
    scene.points.push_back(
        {.point = {seen.point}, .uvd_px = *kRig.project(p_cam), .sigma_px = test::kObservationSigma_px, .flow = {}});
    return p_cam;
  }
  static FeaturesPtr seen(int frame) {
    static std::map<int, FeaturesPtr> rendered;  // the same in all tests, as rendering takes longest
    FeaturesPtr& features = rendered[frame];
    if (!features)
      features =
          TexturedBoard::seen({{placeOf(0, frame), TexturedBoard::person}, {placeOf(1, frame), TexturedBoard::person}});
    return features;
  }
  int next_ = 0;
  ObjectTracker tracker_{{}, kRig};
  std::map<TrackId, std::vector<ObjectObservation>> reported_;
};

TEST(ObjectTracker, APersonOfWhomOnePointWasFollowedOnceIsFollowedByPatches) {
  Sidewalk sidewalk;
  sidewalk.walkOn(1);
  sidewalk.walk({{.point = 0, .person = 0}});
  sidewalk.walkOn(8);
  ASSERT_EQ(sidewalk.reported().size(), 1U);
  const auto& all = sidewalk.reported().begin()->second;
  EXPECT_GE(all.size(), 9U);
  for (const ObjectObservation& o : all) {
    EXPECT_TRUE(o.born_slow) << o.frame.value;
    const Eigen::Vector3d off_m = o.T_cam_body.translation() - Sidewalk::placeOf(0, o.frame.value).translation();
    EXPECT_LT(off_m.norm(), 0.5) << o.frame.value;
  }
}

TEST(ObjectTracker, NobodyIsSpawnedWithoutTheFrameBefore) {
  Sidewalk sidewalk;
  sidewalk.walk({{.point = 0, .person = 0}});
  sidewalk.walkOn(8);
  EXPECT_TRUE(sidewalk.reported().empty());
}

/// The number of people reported where a second one appears in one frame, by this component of a point.
std::size_t peopleWith(const Sidewalk::Seen& second) {
  Sidewalk sidewalk;
  sidewalk.walkOn(1);
  sidewalk.walk({{.point = 0, .person = 0}});
  sidewalk.walkOn(1);
  sidewalk.walk({second});
  sidewalk.walkOn(7);
  return sidewalk.reported().size();
}

TEST(ObjectTracker, ASegmentThatAnObjectClaimsIsNoOtherPerson) {
  EXPECT_EQ(peopleWith({.point = 1, .person = 1}), 2U);
  EXPECT_EQ(peopleWith({.point = 1, .person = 1, .label = PointLabel::kMoving}), 1U);
}

/// A point that was followed from one person to the other by mistake.
TEST(ObjectTracker, APointOfAnObjectIsNoOtherPerson) { EXPECT_EQ(peopleWith({.point = 0, .person = 1}), 1U); }

TEST(ObjectTracker, AnotherPointOnAPersonIsNoOtherPerson) {
  Sidewalk sidewalk;
  sidewalk.walkOn(1);
  sidewalk.walk({{.point = 0, .person = 0}, {.point = 1, .person = 0}});
  sidewalk.walk({{.point = 2, .person = 0}});
  sidewalk.walk({{.point = 3, .person = 1}});
  sidewalk.walkOn(7);
  ASSERT_EQ(sidewalk.reported().size(), 2U);
  EXPECT_EQ(sidewalk.reported().rbegin()->first, TrackId{1}) << "no track was spent in between";
}

/// A walk's direction is soon that of the patches, whatever the first point told.
TEST(ObjectTracker, APersonGoesToASideOfTheDirectionFirstTold) {
  Sidewalk sidewalk;
  sidewalk.walkOn(1);
  sidewalk.walk({{.point = 0, .person = 0, .wrong_mps = 1.2}});
  sidewalk.walkOn(9);
  ASSERT_EQ(sidewalk.reported().size(), 1U);
  // Two frames of patches tell. With a vehicle's slip, .2 m/s of the first direction are left by then.
  constexpr double kLeft_mps = 0.15;
  for (const ObjectObservation& o : sidewalk.reported().begin()->second) {
    if (o.frame.value < 3) continue;
    EXPECT_LT(std::abs(o.velocity_cam_mps.z()), kLeft_mps) << o.frame.value;
  }
}

TEST(ObjectTracker, SomebodyOnWhomNoPointIsFollowedForLongIsFoundAsAWhole) {
  for (const double walk_mps : {0.0, 1.4}) {
    const test::LabelledStreet street({.walk_mps = walk_mps});
    ObjectTracker track({}, test::kNarrowRig);
    for (const LookBack::PastScene& past : street.past.past()) track(past.scene);
    track(street.withoutLabels({street.onBoard_px(0.1, -0.2)}));
    const auto found = track(street.withoutLabels({}, test::LabelledStreet::kNow + 1));
    ASSERT_EQ(found->objects.empty(), walk_mps == 0) << walk_mps;
    for (const ObjectObservation& seen : found->objects) EXPECT_NEAR(seen.velocity_cam_mps.x(), walk_mps, 0.2);
  }
}

}  // namespace
}  // namespace motorcade
