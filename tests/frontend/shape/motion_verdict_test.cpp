#include "frontend/shape/motion_verdict.hpp"

#include <functional>

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
    view_.T_cam_body = SE3(Eigen::Matrix3d::Identity(), {0, 0, kDepth_m});
    now_ = pictureOf([](double, double) { return 0.0; });
  }

  /// Where the content of the image was before is told by how far it has come since, by place.
  MotionVerdict verdict(const std::function<double(double, double)>& came_px) {
    before_ = pictureOf(came_px);
    const SE3 T_before_body(Eigen::Matrix3d::Identity(), {-kAside_m, 0, kDepth_m});
    view_.well_before = {&now_, &before_, T_before_body, SE3{}, FrameId{1}, apart_};
    return motionVerdict(points_seen_ ? &observed_ : nullptr, outline_found_ ? &seen_ : nullptr, view_, kRig);
  }
  /// An object that was known before, around the surface, which goes along with the body.
  void addOther() {
    const Eigen::Vector3d reach_m(4, 4, 1);
    view_.others.push_back({view_.T_cam_body.inverse(), -reach_m, reach_m});
    view_.others.back().T_before_cam = SE3(Eigen::Matrix3d::Identity(), {-kAside_m, 0, 0});
  }

  bool points_seen_ = true, outline_found_ = true;
  double apart_ = kShift_px;

 private:
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

TEST(MotionVerdict, HoldsWhereEstimatesAreOffByACell) {
  Surface surface;
  EXPECT_EQ(surface.verdict([](double, double) { return kShift_px + 1; }), MotionVerdict::kMoved);
  EXPECT_EQ(surface.verdict([](double, double) { return -1.0; }), MotionVerdict::kRested);
}

TEST(MotionVerdict, IsNothingWhereNoPointHasASurfaceThatTells) {
  Surface surface;
  EXPECT_EQ(surface.verdict([](double u, double) { return -u; }), MotionVerdict::kNothing)
      << "stripes along the motion";
  surface.points_seen_ = false;
  EXPECT_EQ(surface.verdict(moved), MotionVerdict::kNothing);
  surface.points_seen_ = true;
  surface.outline_found_ = false;
  EXPECT_EQ(surface.verdict(moved), MotionVerdict::kNothing);
}

TEST(MotionVerdict, IsUntoldWhereMotionAndRestAreHardlyApart) {
  Surface surface;
  surface.points_seen_ = false;
  surface.apart_ = 0.9 * ObjectView::kWellApart;
  EXPECT_EQ(surface.verdict(moved), MotionVerdict::kUntold);
}

/// What moved with another object as well says nothing of this one.
TEST(MotionVerdict, ComparesWithTheObjectThatAPointMayBeOf) {
  Surface surface;
  surface.addOther();
  EXPECT_EQ(surface.verdict(moved), MotionVerdict::kNothing);
}

}  // namespace
}  // namespace motorcade
