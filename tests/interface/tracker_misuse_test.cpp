#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/interface/tracked_drive.hpp"

/// Tests inputs of which no tracker can be made: an Error names the field.
namespace motorcade {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
constexpr std::int64_t kGreatestIndex = std::numeric_limits<std::int64_t>::max();

template <class Value>
struct Misuse {
  std::string field;
  std::function<void(Value&)> spoil;
};

/// The field that a tracker finds fault with, empty where it finds none.
std::string faultOf(const Camera& camera, const Tracker::Options& options = replay()) {
  try {
    const Tracker tracker(camera, options);
  } catch (const Error& error) {
    EXPECT_THAT(std::string(error.what()), testing::StartsWith(error.field() + ": "));
    EXPECT_LT(error.field().size() + 10, std::string(error.what()).size()) << "no word of how to mend it";
    return error.field();
  }
  return {};
}

Camera rig() {
  const Camera::Lens lens{.fx_px = 458, .fy_px = 457, .cx_px = 376, .cy_px = 240};
  return {.width_px = 752,
          .height_px = 480,
          .rig = Camera::Rig{.left = lens, .right = lens, .T_right_left = {1, 0, 0, -0.11, 0, 1, 0, 0, 0, 0, 1, 0}}};
}

TEST(TrackerMisuse, EachBadFieldOfACameraIsNamed) {
  const std::vector<Misuse<Camera>> misuses = {
      {"camera.width_px", [](Camera& c) { c.width_px = 0; }},
      {"camera.ignored.left_px", [](Camera& c) { c.ignored.left_px = c.width_px; }},
      {"camera.ignored.top_px", [](Camera& c) { c.ignored.top_px = -1; }},
      {"camera.ignored.right_px", [](Camera& c) { c.ignored.right_px = c.width_px; }},
      {"camera.ignored.bottom_px", [](Camera& c) { c.ignored.bottom_px = c.height_px; }},
      {"camera.ignored.mask", [](Camera& c) { c.ignored.mask.resize(7); }},
      {"camera.sigmas.focal", [](Camera& c) { c.sigmas = {.focal = -0.001}; }},
      {"camera.sigmas.disparity_px", [](Camera& c) { c.sigmas = {.disparity_px = 11}; }},
      {"camera.width_px", [](Camera& c) { c.width_px = -752; }},
      {"camera.width_px", [](Camera& c) { c.width_px = std::numeric_limits<int>::max(); }},
      {"camera.height_px", [](Camera& c) { c.height_px = 0; }},
      {"camera.height_px", [](Camera& c) { c.width_px = c.height_px = 16384; }},  // more than 2^26 pixels
      {"camera.fx_px", [](Camera& c) { c.fx_px = 0; }},
      {"camera.fx_px", [](Camera& c) { c.fx_px = kNan; }},
      {"camera.fy_px", [](Camera& c) { c.fy_px = -60; }},
      {"camera.fy_px", [](Camera& c) { c.fy_px = kInfinity; }},
      {"camera.fy_px", [](Camera& c) { c.fy_px = 1e-300; }},
      {"camera.cx_px", [](Camera& c) { c.cx_px = kNan; }},
      {"camera.cx_px", [](Camera& c) { c.cx_px = 64; }},
      {"camera.cy_px", [](Camera& c) { c.cy_px = -1; }},
      {"camera.baseline_m", [](Camera& c) { c.baseline_m = 0; }},
      {"camera.baseline_m", [](Camera& c) { c.baseline_m = -0.5; }},
      {"camera.baseline_m", [](Camera& c) { c.baseline_m = kNan; }},
      {"camera.baseline_m", [](Camera& c) { c.baseline_m = 540; }},  // millimeters
  };
  ASSERT_EQ(faultOf(blankDrive(0).camera), "");
  for (std::size_t i = 0; i < misuses.size(); ++i) {
    Camera camera = blankDrive(0).camera;
    misuses[i].spoil(camera);
    EXPECT_EQ(faultOf(camera), misuses[i].field) << "misuse " << i;
  }
  EXPECT_EQ(faultOf(Camera{}), "camera.width_px");
}

TEST(TrackerMisuse, EachBadFieldOfARigIsNamed) {
  const std::vector<Misuse<Camera>> misuses = {
      {"camera.rig.left.fx_px", [](Camera& c) { c.rig->left.fx_px = 0; }},
      {"camera.rig.left.cy_px", [](Camera& c) { c.rig->left.cy_px = kNan; }},
      {"camera.rig.right.fy_px", [](Camera& c) { c.rig->right.fy_px = -1; }},
      {"camera.rig.right.cx_px", [](Camera& c) { c.rig->right.cx_px = 752; }},
      {"camera.rig.left.distortion", [](Camera& c) { c.rig->left.distortion = Camera::Distortion{7}; }},
      {"camera.rig.left.coefficients", [](Camera& c) { c.rig->left.coefficients[0] = -0.28; }},  // of no model
      {"camera.rig.right.coefficients",
       [](Camera& c) {
         c.rig->right.distortion = Camera::Distortion::kEquidistant;
         c.rig->right.coefficients[4] = 0.1;
       }},
      {"camera.rig.right.coefficients",
       [](Camera& c) {
         c.rig->right.distortion = Camera::Distortion::kRadialTangential;
         c.rig->right.coefficients[1] = kNan;
       }},
      {"camera.rig.T_right_left", [](Camera& c) { c.rig->T_right_left = {}; }},
      {"camera.rig.T_right_left", [](Camera& c) { c.rig->T_right_left[3] = 0; }},     // at one place
      {"camera.rig.T_right_left", [](Camera& c) { c.rig->T_right_left[3] = 0.11; }},  // exchanged
      {"camera.rig.T_right_left", [](Camera& c) { c.rig->T_right_left[3] = -110; }},  // millimeters
      {"camera.rig.T_right_left", [](Camera& c) { c.rig->T_right_left[11] = kNan; }},
      {"camera.rig.T_right_left", [](Camera& c) { c.rig->T_right_left[0] = -1; }},  // a mirror
  };
  ASSERT_EQ(faultOf(rig()), "");
  for (std::size_t i = 0; i < misuses.size(); ++i) {
    Camera camera = rig();
    misuses[i].spoil(camera);
    EXPECT_EQ(faultOf(camera), misuses[i].field) << "misuse " << i;
  }
}

/// A lens of which nothing can be made is a fault, or gives some camera; it never hangs nor crashes.
TEST(TrackerMisuse, AbsurdDistortionEndsInAnErrorOrACamera) {
  for (const auto distortion : {Camera::Distortion::kRadialTangential, Camera::Distortion::kEquidistant})
    for (const double size : {-9e5, -10.0, -1.0, 1.0, 10.0, 9e5}) {
      Camera camera = rig();
      camera.rig->left.distortion = camera.rig->right.distortion = distortion;
      camera.rig->left.coefficients = {size, size, 0, 0};
      EXPECT_THAT(faultOf(camera), testing::AnyOf("", HasSubstr("camera.rig"))) << size;
    }
}

TEST(TrackerMisuse, EachBadOptionIsNamed) {
  const std::vector<Misuse<Tracker::Options>> misuses = {
      {"options.policy", [](Tracker::Options& o) { o.policy = Tracker::Policy{5}; }},
      {"options.axes", [](Tracker::Options& o) { o.axes = Tracker::Axes{-1}; }},
      {"options.threads", [](Tracker::Options& o) { o.threads = 0; }},
      {"options.threads", [](Tracker::Options& o) { o.threads = 65; }},
      {"options.realtime_priority", [](Tracker::Options& o) { o.realtime_priority = -1; }},
      {"options.realtime_priority", [](Tracker::Options& o) { o.realtime_priority = 100; }},
      {"options.covariance_frames", [](Tracker::Options& o) { o.covariance_frames = 0; }},
      {"options.covariance_frames", [](Tracker::Options& o) { o.covariance_frames = 61; }},
      {"options.cpus", [](Tracker::Options& o) { o.cpus = {-1}; }},
      {"options.cpus",
       [](Tracker::Options& o) {
         o.cpus = {0, 1000};
       }},
      {"options.cpus", [](Tracker::Options& o) { o.cpus = {1 << 30}; }},
      {"options.patience", [](Tracker::Options& o) { o.patience = milliseconds(-1); }},
      {"options.settings", [](Tracker::Options& o) { o.settings = "no_such.key = 1"; }},
      {"options.settings", [](Tracker::Options& o) { o.settings = "frontend.max_points = -3"; }},
      {"options.settings", [](Tracker::Options& o) { o.settings = "this is no line"; }},
      {"options.settings", [](Tracker::Options& o) { o.settings = "pipeline.threads = 7"; }},  // beside options.threads
      {"options.settings", [](Tracker::Options& o) { o.settings = "pipeline.policy = \"live\""; }},
      {"options.settings",
       [](Tracker::Options& o) { o.settings = "backend.budget_ms = 5"; }},  // no replay of it repeats
  };
  for (std::size_t i = 0; i < misuses.size(); ++i) {
    Tracker::Options options = replay();
    misuses[i].spoil(options);
    EXPECT_EQ(faultOf(blankDrive(0).camera, options), misuses[i].field) << "misuse " << i;
  }
  Tracker::Options agreeing = replay(2);
  agreeing.settings = "pipeline.threads = 2\npipeline.policy = \"replay\"\npipeline.frames_in_flight = 2";
  EXPECT_EQ(faultOf(blankDrive(0).camera, agreeing), "");
  EXPECT_EQ(faultOf(blankDrive(0).camera, {.settings = "backend.budget_ms = 5"}), "");  // the default is live
}

TEST(TrackerMisuse, ALogThatThrowsCostsNoResult) {
  const DriveInMemory drive = readDrive(MOTORCADE_TINY_SEQUENCE);
  std::atomic<int> lines = 0;
  Tracker::Options options = replay();
  options.log = [&](Tracker::LogLevel, const std::string&) {
    ++lines;
    throw 1;
  };
  Tracker tracker(drive.camera, options);
  std::size_t accepted = 0;
  for (std::size_t i = 0; i < drive.frames.size(); ++i) {
    const bool twice = i % 3 == 1;  // each is logged by the pair that follows
    for (int times = 0; times <= (twice ? 1 : 0); ++times)
      if (tracker.push(drive.pair(i)).status == Tracker::Push::Status::kAccepted) ++accepted;
  }
  tracker.close();
  EXPECT_EQ(accepted, drive.frames.size());
  EXPECT_EQ(rest(tracker).size(), accepted);
  EXPECT_GE(lines, 4);
}

TEST(RecordingMisuse, NamesWhatIsWrong) {
  const auto field = [](const auto& act) -> std::string {
    try {
      act();
    } catch (const Error& error) {
      return error.field();
    }
    return {};
  };
  EXPECT_EQ(field([] { Recording("/no/such/folder"); }), "folder");
  Recording recording(MOTORCADE_TINY_SEQUENCE);
  EXPECT_EQ(field([&] { recording.read(-1); }), "index");
  EXPECT_EQ(field([&] { recording.read(recording.size()); }), "index");
  EXPECT_EQ(field([&] { recording.read(kGreatestIndex); }), "index");
}

}  // namespace
}  // namespace motorcade
