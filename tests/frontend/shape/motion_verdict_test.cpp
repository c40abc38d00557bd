#include "frontend/shape/motion_verdict.hpp"

#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/frontend/texture.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade {
namespace {

using test::kRig;

constexpr int kSeenLevel = 1;
constexpr double kDepth_m = 12, kAside_m = 0.6;  // to the right, by which the body came since the frame before

/// The shift of what came along with the body [px of the level].
const double kShift_px = kRig.fx_px * kAside_m / kDepth_m / (1 << kSeenLevel);

/// A surface at one depth that fills the window, and five by five points on it.
class Surface {
 public:
  Surface() {
    seen_.level = kSeenLevel;
    seen_.map.window = {.u0 = 250, .v0 = 40, .width = 120, .height = 100};
    seen_.map.disparity_px.assign(120 * 100, static_cast<float>(disparity_px() / (1 << kSeenLevel)));
    for (int row = 0; row < 5; ++row)
      for (int column = 0; column < 5; ++column) {
        PointMeasurement& point = observed_.measured.emplace_back();
        point.uvd_px = Eigen::Vector3d(580 + 20 * column, 140 + 20 * row, disparity_px()).cast<float>();
      }
    view_.ground.height_m = 5;
    view_.T_cam_body = SE3(Eigen::Matrix3d::Identity(), {0, 0, kDepth_m});
    now_ = pictureOf([](double, double) { return 0.0; });
  }

  /// Verdict on an image whose content has come so far since the one before, by place.
  MotionVerdict verdict(const std::function<double(double, double)>& came_px) {
    before_ = pictureOf(came_px);
    const SE3 T_before_cam(Eigen::Matrix3d::Identity(), {camera_aside_m, 0, 0});
    const SE3 T_before_body(Eigen::Matrix3d::Identity(), {camera_aside_m - aside_m, 0, kDepth_m});
    view_.well_before = {&now_, &before_, T_before_body, T_before_cam, FrameId{1}, apart};
    return motionVerdict(points_seen ? &observed_ : nullptr, outline_found ? &seen_ : nullptr, view_, kRig);
  }
  /// Adds an object that was known before, around the surface or so far before it, which goes along with the body.
  void addOther(double nearer_m = 0) { view_.others.push_back(along(nearer_m, -kAside_m)); }
  /// Adds a lost object, which goes another way or along with the body.
  void addLost(bool goes_along) { view_.lost.push_back(along(0, goes_along ? -kAside_m : 0)); }
  /// Adds so many points at rest between those of the surface, so much nearer than it, from a column on.
  void addRest(int points, double nearer_m, double first_px = 590) {
    const SceneFlow none{
        .p_cam = Eigen::Vector3d::Zero(), .velocity_mps = Eigen::Vector3d::Zero(), .covariance = Matrix6d::Identity()};
    for (int i = 0; i < points; ++i)
      rest_.push_back({.point = {static_cast<std::int64_t>(rest_.size())},
                       .uvd_px = {first_px + 5 * i, 150.0, kRig.fx_px * kRig.baseline_m / (kDepth_m - nearer_m)},
                       .sigma_px = Eigen::Vector3d::Constant(0.2),
                       .label = PointLabel::kStatic,
                       .flow = none});
    view_.scene = rest_;
  }
  /// The first of these points have a second match.
  void makeAmbiguous(int points) {
    for (int i = 0; i < points; ++i) rest_[i].ambiguous = true;
  }
  void lowerTo(double camera_height_m) { view_.ground.height_m = camera_height_m; }
  /// Follows none of the points of what may be a person any more, but finds them as patches.
  void followByPatches() {
    view_.small = true;
    std::swap(observed_.measured, observed_.patches);
  }
  /// Follows neither points nor patches of what may be a person any more.
  void followNothing(bool small) {
    view_.small = small;
    observed_.measured.clear(), observed_.patches.clear();
  }
  /// Gives the body the width of a person [cells].
  void widenTo(double width) { view_.small = true, view_.width = width; }
  /// Forgets all points but so many of the lowest.
  void keep(int points) { observed_.measured.erase(observed_.measured.begin(), observed_.measured.end() - points); }

  bool points_seen = true, outline_found = true;
  double apart = kShift_px;
  double aside_m = kAside_m, camera_aside_m = 0;  // by which the body and the camera came

 private:
  ObjectView::Other along(double nearer_m, double came_m) const {
    const Eigen::Vector3d reach_m(4, 4, 1), middle_m(0, 0, -nearer_m);
    ObjectView::Other other{view_.T_cam_body.inverse(), middle_m - reach_m, middle_m + reach_m};
    other.T_before_cam = SE3(Eigen::Matrix3d::Identity(), {came_m, 0, 0});
    return other;
  }
  static double disparity_px() { return kRig.fx_px * kRig.baseline_m / kDepth_m; }
  ImagePyramid pictureOf(const std::function<double(double, double)>& came_px) const {
    ImagePyramid images;
    images.levels.emplace_back();  // nobody looks at the finest level
    images.levels.push_back(test::render(kRig.width_px >> kSeenLevel, kRig.height_px >> kSeenLevel,
                                         [&](double u, double v) { return texture_(u + came_px(u, v), v); }));
    return images;
  }

  test::Texture texture_{7};
  ObjectView view_;
  LevelDisparities seen_;
  ObjectObservation observed_;
  std::vector<ScenePoint> rest_;
  ImagePyramid now_, before_;
};

double moved(double, double) { return kShift_px; }
double rested(double, double) { return 0; }

TEST(MotionVerdict, TellsWhatMovedFromWhatRested) {
  Surface surface;
  EXPECT_EQ(surface.verdict(moved), MotionVerdict::kMoved);
  EXPECT_EQ(surface.verdict(rested), MotionVerdict::kRested);
  EXPECT_EQ(surface.verdict([](double, double v) { return v < 90 ? kShift_px : 0; }), MotionVerdict::kMixed);
}

TEST(MotionVerdict, IsHardlyOneOfAPointOrTwo) {
  Surface surface;
  surface.keep(3);
  EXPECT_EQ(surface.verdict(moved), MotionVerdict::kMoved);
  surface.keep(2);
  EXPECT_EQ(surface.verdict(moved), MotionVerdict::kHardly);
  EXPECT_EQ(surface.verdict(rested), MotionVerdict::kRested);
}

/// Points at the border of a body may lie on what is behind it.
TEST(MotionVerdict, IsRestedOnlyWhereHalfOfThePointsSayIt) {
  Surface surface;
  const auto rest_above = [](double row) {  // and stripes below, which tell nothing
    return [row](double u, double v) { return v < row ? 0 : -u; };
  };
  EXPECT_EQ(surface.verdict(rest_above(75)), MotionVerdict::kMixed);
  EXPECT_EQ(surface.verdict(rest_above(105)), MotionVerdict::kRested);
}

TEST(MotionVerdict, AsksThePatchesOfAPerson) {
  Surface surface;
  surface.followByPatches();
  EXPECT_EQ(surface.verdict(moved), MotionVerdict::kMoved);
  EXPECT_EQ(surface.verdict(rested), MotionVerdict::kRested);
  const auto at_the_top = [](double u, double v) { return v < 75 ? kShift_px : -u; };  // and stripes below
  EXPECT_EQ(surface.verdict(at_the_top), MotionVerdict::kNothing) << "few of them tell";
}

TEST(MotionVerdict, IsUntoldOfAPersonOfWhomNothingIsFollowed) {
  Surface person, car;
  person.followNothing(true), car.followNothing(false);
  EXPECT_EQ(person.verdict(moved), MotionVerdict::kUntold);
  EXPECT_EQ(car.verdict(moved), MotionVerdict::kNothing);
}

/// An evenly dressed person looks the same after half a step.
TEST(MotionVerdict, IsUntoldOfAPersonWhoRestedUntilItWentByItsWidth) {
  Surface person;
  person.widenTo(kShift_px + 1);
  EXPECT_EQ(person.verdict(rested), MotionVerdict::kUntold);
  EXPECT_EQ(person.verdict([](double, double v) { return v < 90 ? kShift_px : 0; }), MotionVerdict::kUntold);
  EXPECT_EQ(person.verdict(moved), MotionVerdict::kMoved) << "what moved tells at once";
  person.widenTo(kShift_px - 1);
  EXPECT_EQ(person.verdict(rested), MotionVerdict::kRested);
}

TEST(MotionVerdict, HoldsWhereEstimatesAreOffByACell) {
  Surface surface;
  EXPECT_EQ(surface.verdict([](double, double) { return kShift_px + 1; }), MotionVerdict::kMoved);
  EXPECT_EQ(surface.verdict([](double, double) { return -1.0; }), MotionVerdict::kRested);
}

/// An error of the disparity moves the place of what rests along its epipolar line.
TEST(MotionVerdict, TakesNoMotionThatHalfAPixelOfDisparityExplains) {
  constexpr double kCame_m = 6;  // half a pixel of 32 px is 0.09 m of it
  const auto verdict_of = [](double aside_m) {
    Surface surface;
    surface.aside_m = aside_m, surface.camera_aside_m = kCame_m;
    return surface.verdict([aside_m](double, double) { return kShift_px / kAside_m * (aside_m - kCame_m); });
  };
  EXPECT_EQ(verdict_of(0.17), MotionVerdict::kNothing);
  EXPECT_EQ(verdict_of(-0.17), MotionVerdict::kNothing);
  EXPECT_EQ(verdict_of(0.25), MotionVerdict::kMoved);
}

TEST(MotionVerdict, IsNothingWhereNoPointHasASurfaceThatTells) {
  Surface surface;
  EXPECT_EQ(surface.verdict([](double u, double) { return -u; }), MotionVerdict::kNothing)
      << "stripes along the motion";
  surface.points_seen = false;
  EXPECT_EQ(surface.verdict(moved), MotionVerdict::kNothing);
  surface.points_seen = true;
  surface.outline_found = false;
  EXPECT_EQ(surface.verdict(moved), MotionVerdict::kNothing);
}

TEST(MotionVerdict, IsUntoldWhereMotionAndRestAreHardlyApart) {
  Surface surface;
  surface.points_seen = false;
  surface.apart = 0.9 * ObjectView::kWellApart;
  EXPECT_EQ(surface.verdict(moved), MotionVerdict::kUntold);
}

/// A surface that moved with another object as well says nothing of this one, although it is not within the other.
TEST(MotionVerdict, ComparesWithTheObjectThatAPointMayBeOf) {
  Surface surface;
  surface.addOther(1.4);
  EXPECT_EQ(surface.verdict(moved), MotionVerdict::kNothing);
}

TEST(MotionVerdict, TellsWhatLiesWithinAnObjectThatWasKnownBefore) {
  Surface surface;
  surface.addOther(1.2);
  EXPECT_EQ(surface.verdict(moved), MotionVerdict::kWithin);
}

TEST(MotionVerdict, IsOfWhatWasLostUnlessItIsFoundAgain) {
  Surface part, found_again;
  part.addLost(false), found_again.addLost(true);
  EXPECT_EQ(part.verdict(moved), MotionVerdict::kWithin);
  EXPECT_EQ(found_again.verdict(moved), MotionVerdict::kMoved);
}

TEST(MotionVerdict, TellsAShadowOnTheRoad) {
  constexpr double kLowest_m = 0.54;  // below the camera
  Surface surface;
  surface.lowerTo(kLowest_m + 0.1);
  EXPECT_EQ(surface.verdict(moved), MotionVerdict::kMoved) << "one of five rows of points is on the road";
  surface.keep(5);
  EXPECT_EQ(surface.verdict(moved), MotionVerdict::kOnRoad);
  surface.lowerTo(kLowest_m + 0.3);
  EXPECT_EQ(surface.verdict(moved), MotionVerdict::kMoved);
}

/// The surface of a parked car mirrors somebody who walks by.
TEST(MotionVerdict, TellsAMirrorImageByTheNearerSurfaceAroundIt) {
  Surface few, near, mirrored, behind;
  few.addRest(4, 3), near.addRest(8, 0.8), mirrored.addRest(8, 3), behind.addRest(8, -3);
  EXPECT_EQ(few.verdict(moved), MotionVerdict::kMoved);
  EXPECT_EQ(near.verdict(moved), MotionVerdict::kMoved) << "it may be the body's own depth";
  EXPECT_EQ(mirrored.verdict(moved), MotionVerdict::kBehind);
  EXPECT_EQ(behind.verdict(moved), MotionVerdict::kMoved);
  mirrored.addRest(4, -3);
  EXPECT_EQ(mirrored.verdict(moved), MotionVerdict::kMoved) << "a pole before a body leaves what is behind to be seen";
}

TEST(MotionVerdict, ABodyGoesBehindWhatIsNearerToOneSide) {
  constexpr double kRight_px = 640;
  Surface left, right, both;
  left.addRest(5, 3), right.addRest(5, 3, kRight_px), both.addRest(5, 3), both.addRest(5, 3, kRight_px);
  EXPECT_EQ(left.verdict(moved), MotionVerdict::kMoved);
  EXPECT_EQ(right.verdict(moved), MotionVerdict::kMoved);
  EXPECT_EQ(both.verdict(moved), MotionVerdict::kBehind);
}

/// A few bars of a fence were taken for one another, so that they seem to move.
TEST(MotionVerdict, TellsTextureThatRepeatsByThePointsAroundIt) {
  const auto verdict_of = [](int points, int ambiguous, double nearer_m) {
    Surface surface;
    surface.addRest(points, nearer_m);
    surface.makeAmbiguous(ambiguous);
    return surface.verdict(moved);
  };
  EXPECT_EQ(verdict_of(10, 4, 0), MotionVerdict::kRepeats);
  EXPECT_EQ(verdict_of(10, 3, 0), MotionVerdict::kMoved);
  EXPECT_EQ(verdict_of(2, 2, 0), MotionVerdict::kMoved) << "two points are no texture";
  EXPECT_EQ(verdict_of(10, 10, -4), MotionVerdict::kMoved) << "a fence behind the body";
}

TEST(MotionVerdict, RestContradictsAnEstimateThatSurelyGoesOn) {
  ObjectEstimate object;
  object.state = ObjectState::kStopped;
  const auto contradicts = [&](double speed_mps, double sigma_mps) {
    object.velocity_world_mps = {0, 0, speed_mps};
    return restsDespiteEstimate(object, sigma_mps);
  };
  EXPECT_TRUE(contradicts(2, 0.5));
  EXPECT_FALSE(contradicts(2, 1.5)) << "hardly sure";
  EXPECT_FALSE(contradicts(0.8, 0.1)) << "about to stand or to start";
  object.state = ObjectState::kMoving;
  EXPECT_FALSE(contradicts(2, 0.5));
}

}  // namespace
}  // namespace motorcade
