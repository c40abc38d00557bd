#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "apps/synth/output/ground_truth.hpp"
#include "apps/synth/output/sequence_writer.hpp"
#include "apps/synth/rendering/renderer.hpp"
#include "apps/synth/scenes/scene_builder.hpp"
#include "io/images/image_file.hpp"
#include "io/sequence/calibration.hpp"
#include "tests/apps/synth/rendered_scene.hpp"
#include "tests/io/temporary_folder.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade::synth {
namespace {

int indexOf(int x, int y) { return y * kSmallCamera.width_px + x; }

Eigen::Vector3d behindPixel(const Rendering& left, int x, int y) {
  return kSmallCamera.triangulate(
      {static_cast<double>(x), static_cast<double>(y),
       kSmallCamera.fx_px * kSmallCamera.baseline_m / static_cast<double>(left.depth_m[indexOf(x, y)])});
}

/// Footprints overlap when a point on the outline or middle line of one lies in the other.
bool overlap(const Placed& a, const Placed& b, double clearance_m) {
  const SE3 T_a_b = a.T_map_body.inverse() * b.T_map_body;
  for (double x = -0.5; x <= 0.5; x += 0.1)
    for (const double y : {-0.5, 0.0, 0.5}) {
      const Eigen::Vector3d p = T_a_b * Eigen::Vector3d(x * b.model->length_m, y * b.model->width_m, 0);
      if (std::abs(p.x()) < 0.5 * a.model->length_m + clearance_m &&
          std::abs(p.y()) < 0.5 * a.model->width_m + clearance_m)
        return true;
    }
  return false;
}

TEST(SynthRays, MeetWhatTryingEveryPartFinds) {
  for (const char* name : {"urban", "highway"}) {
    const Scene scene = makeScene(name, 2);
    const FrameScene frame(scene, 30, true);
    const CameraRays rays(frame, kSmallCamera, StereoSide::kRight);
    const ParallelRays to_sun(frame, scene.sun);
    Random random(5);
    for (int i = 0; i < 3000; ++i) {
      const float u_px = random.uniform(-0.5F, 413.5F), v_px = random.uniform(-0.5F, 124.5F);
      const Vec3 d = rays.direction(u_px, v_px);
      const auto hit = rays.firstHit(u_px, v_px, d, 300);
      const float t = nearestOfAll(frame, rays.origin(), d, 1e-3F, 300);
      ASSERT_NEAR(hit ? hit->t : 300, t, 1e-5F * t) << name << " " << u_px << " " << v_px;  // float rounding
      const Vec3 origin = rays.origin() + d * (0.99F * t);
      ASSERT_EQ(to_sun.occluded(origin, 60), nearestOfAll(frame, origin, scene.sun, 1e-4F, 60) < 60)
          << name << " " << u_px << " " << v_px;
    }
  }
}

TEST(SynthRenderer, DepthsLieOnTheRoadAndInsideTheVehicles) {
  const Scene scene = makeScene("static", 3);
  const FrameScene frame(scene, 5, true);
  const Rendering left = render(frame, kSmallCamera, StereoSide::kLeft, kNoNoise);
  int road = 0, vehicle = 0;
  for (int y = 0; y < kSmallCamera.height_px; ++y)
    for (int x = 0; x < kSmallCamera.width_px; ++x) {
      if (left.depth_m[indexOf(x, y)] <= 0) continue;
      const Eigen::Vector3d p_map = frame.T_map_cam() * behindPixel(left, x, y);
      ASSERT_GT(p_map.z(), -1e-3);  // single precision at 100 m
      const int id = left.object[indexOf(x, y)];
      road += id < 0 && std::abs(p_map.z()) < 1e-3 ? 1 : 0;
      if (id < 0) continue;
      const auto placed =
          std::find_if(frame.placed().begin(), frame.placed().end(), [&](const Placed& p) { return p.id == id; });
      const Eigen::Vector3d p_body = placed->T_map_body.inverse() * p_map;
      EXPECT_LE(std::abs(p_body.x()), 0.5 * placed->model->length_m + 0.01);
      EXPECT_LE(std::abs(p_body.y()), 0.5 * placed->model->width_m + 0.01);
      EXPECT_LE(p_body.z(), placed->model->height_m + 0.01);
      ++vehicle;
    }
  EXPECT_GT(road, kSmallCamera.width_px * kSmallCamera.height_px / 6);
  EXPECT_GT(vehicle, 200);
}

/// Difference between the right image and the left one where both see the same surface.
struct EyeDifference {
  std::size_t pixels = 0;
  double median_levels = 0, shift_px = 0;
};
EyeDifference eyeDifference(const FrameScene& frame) {
  const Rendering left = render(frame, kSmallCamera, StereoSide::kLeft, kNoNoise),
                  right = render(frame, kSmallCamera, StereoSide::kRight, kNoNoise);
  std::vector<double> differences;
  double shift = 0, weight = 0;
  for (int y = 1; y < kSmallCamera.height_px - 1; ++y)
    for (int x = 1; x < kSmallCamera.width_px - 1; ++x) {
      const double depth = left.depth_m[indexOf(x, y)];
      if (depth <= 0) continue;
      const double u = x - kSmallCamera.fx_px * kSmallCamera.baseline_m / depth;
      const int u0 = static_cast<int>(std::floor(u));
      if (u0 < 1 || u0 + 2 >= kSmallCamera.width_px) continue;
      const bool same = std::abs(right.depth_m[indexOf(u0, y)] - depth) < 0.02 * depth &&
                        std::abs(right.depth_m[indexOf(u0 + 1, y)] - depth) < 0.02 * depth;
      if (!same) continue;
      const double t = u - u0, sample = (1 - t) * right.image.at(u0, y) + t * right.image.at(u0 + 1, y);
      const double slope = 0.25 * (right.image.at(u0 + 2, y) - right.image.at(u0 - 1, y) + right.image.at(u0 + 1, y) -
                                   right.image.at(u0, y));
      differences.push_back(std::abs(sample - left.image.at(x, y)));
      if (differences.back() < 20) {
        shift += slope * (sample - left.image.at(x, y));
        weight += slope * slope;
      }
    }
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  return {differences.size(), *middle, shift / weight};
}

TEST(SynthRenderer, TheRightEyeShowsTheLeftPictureShiftedByTheDisparity) {
  for (const char* name : {"overtake", "brick", "corner", "hedges", "windy", "parked"}) {
    const Scene scene = makeScene(name, 2);
    const EyeDifference eyes = eyeDifference(FrameScene(scene, 14, true));
    constexpr double kInterpolation = 2.5;  // gray levels of 255: linear interpolation of a sharp picture
    ASSERT_GT(eyes.pixels, 10000U) << name;
    EXPECT_LT(eyes.median_levels, kInterpolation) << name;
    EXPECT_LT(std::abs(eyes.shift_px), 0.03) << name;  // no bias of the whole; joints of bricks are a pixel wide
  }
}

TEST(SynthRenderer, NoiseDiffersBetweenTheEyesAndHasTheSizeAskedFor) {
  const Scene scene = makeScene("static", 1);
  const FrameScene frame(scene, 0, true);
  RenderOptions noisy = kNoNoise;
  noisy.noise_levels = 1.5F;
  std::vector<double> left, right;
  for (const StereoSide side : {StereoSide::kLeft, StereoSide::kRight}) {
    const auto clean = pixels(render(frame, kSmallCamera, side, kNoNoise).image),
               with = pixels(render(frame, kSmallCamera, side, noisy).image);
    for (std::size_t i = 0; i < clean.size(); ++i)
      if (clean[i] > 100 && clean[i] < 150)
        (side == StereoSide::kLeft ? left : right).push_back(static_cast<double>(with[i]) - clean[i]);
  }
  const double power =
      std::inner_product(left.begin(), left.end(), left.begin(), 0.0) / static_cast<double>(left.size());
  EXPECT_NEAR(std::sqrt(power), 1.5, 0.2);  // signal dependent, and rounded twice
  EXPECT_FALSE(std::equal(left.begin(), left.begin() + 100, right.begin()));
}

TEST(SynthGroundTruth, LabelsAgreeWithPosesAndMasks) {
  for (const char* name : {"overtake", "urban", "convoy", "traffic", "rain", "people"}) {
    const Scene scene = makeScene(name, 4);
    const FrameScene frame(scene, 20, true);
    const Rendering left = render(frame, kSmallCamera, StereoSide::kLeft, kNoNoise);
    const auto labels = labelsOf(frame, kSmallCamera, left);
    ASSERT_GE(labels.size(), 2U);
    for (const auto& label : labels) {
      if (label.truncated == 0) {
        const Eigen::Vector3d middle = label.location_cam - Eigen::Vector3d(0, 0.5 * label.height_m, 0);
        const auto uvd = kSmallCamera.project(middle);
        ASSERT_TRUE(uvd);
        EXPECT_GT(uvd->x(), label.left_px);
        EXPECT_LT(uvd->x(), label.right_px);
        EXPECT_GT(uvd->y(), label.top_px);
        EXPECT_LT(uvd->y(), label.bottom_px);
      }
      const Eigen::AlignedBox2d box(Eigen::Vector2d(label.left_px - 0.01, label.top_px - 0.01),
                                    Eigen::Vector2d(label.right_px + 0.01, label.bottom_px + 0.01));
      for (const Eigen::Vector2d& pixel : pixelsOf(left, kSmallCamera, label.id))
        ASSERT_TRUE(box.contains(pixel)) << name << " " << label.id << " at " << pixel.transpose();
    }
  }
}

TEST(SynthSequence, IsTheSameForASeedAndAnyThreadCountAndStartsAtTheIdentity) {
  const test::TemporaryFolder folder;
  const Scene scene = makeScene("overtake", 5);
  WriteOptions options;
  options.frames = 2;
  options.camera = kittiCamera(248, 75);
  options.render.threads = 1;
  writeSequence(scene, folder / "one", options);
  options.render.threads = 3;
  writeSequence(makeScene("overtake", 5), folder / "three", options);
  for (const char* file : {"image_0/000001.png", "image_1/000001.png", "disp/000001.png", "instance/000001.png",
                           "poses.txt", "label_02.txt", "object_poses.txt", "calib.txt", "times.txt"})
    EXPECT_EQ(test::contentOf(folder / "one" / file), test::contentOf(folder / "three" / file)) << file;
  writeSequence(makeScene("overtake", 6), folder / "other", options);
  EXPECT_NE(test::contentOf(folder / "one/image_0/000001.png"), test::contentOf(folder / "other/image_0/000001.png"));
  EXPECT_EQ(test::contentOf(folder / "one/poses.txt").substr(0, 11), "1.000000000");
  const auto disparity = readPng16(folder / "one/disp/000001.png");
  EXPECT_GT(disparity.pixels[70 * 248 + 124], 0);
}

WriteOptions oneSmallPair() {
  WriteOptions options;
  options.frames = 1;
  options.camera = kittiCamera(248, 75);
  options.render = kNoNoise;
  return options;
}

TEST(SynthSequence, ARigErrorMovesTheRightImageAloneAndByWhatWasAsked) {
  const test::TemporaryFolder folder;
  const Scene scene = makeScene("overtake", 5);
  WriteOptions options = oneSmallPair();
  writeSequence(scene, folder / "exact", options);
  constexpr int kRight_px = 3, kDown_px = 2;
  options.rig_error = {.disparity_offset_px = kRight_px, .row_offset_px = kDown_px};
  writeSequence(scene, folder / "off", options);
  for (const char* file : {"image_0/000000.png", "disp/000000.png", "instance/000000.png", "label_02.txt"})
    EXPECT_EQ(test::contentOf(folder / "exact" / file), test::contentOf(folder / "off" / file)) << file;
  ImagePool pool;
  const Image exact = readImage(folder / "exact/image_1/000000.png", pool),
              off = readImage(folder / "off/image_1/000000.png", pool);
  int equal = 0, all = 0;
  for (int y = kDown_px + 1; y < exact.height() - 1; ++y)
    for (int x = kRight_px + 1; x < exact.width() - 1; ++x, ++all)
      equal += off.at(x, y) == exact.at(x - kRight_px, y - kDown_px) ? 1 : 0;
  EXPECT_GT(equal, 0.99 * all);  // single precision of the rays changes a pixel on an edge here and there
}

TEST(SynthSequence, ErrorsOfTheCalibrationBendBothImagesAndAreNotTold) {
  const test::TemporaryFolder folder;
  const Scene scene = makeScene("overtake", 5);
  WriteOptions options = oneSmallPair();
  writeSequence(scene, folder / "exact", options);
  options.rig_error = {.calibration = 1};
  writeSequence(scene, folder / "off", options);
  EXPECT_EQ(test::contentOf(folder / "exact/poses.txt"), test::contentOf(folder / "off/poses.txt"));
  for (const char* file : {"image_0/000000.png", "image_1/000000.png"})
    EXPECT_NE(test::contentOf(folder / "exact" / file), test::contentOf(folder / "off" / file)) << file;
  EXPECT_EQ(readCalibration(folder / "exact/calib.txt").sigmas, (CalibrationSigmas{0, 0, 0, 0, 0}));
  EXPECT_FALSE(readCalibration(folder / "off/calib.txt").sigmas);
}

TEST(SynthSequence, AShakeMovesTheRightImageAlone) {
  const test::TemporaryFolder folder;
  const Scene scene = makeScene("overtake", 5);
  WriteOptions options = oneSmallPair();
  writeSequence(scene, folder / "still", options);
  options.rig_error = {.shake_px = 1};
  writeSequence(scene, folder / "shaken", options);
  EXPECT_EQ(test::contentOf(folder / "still/image_0/000000.png"),
            test::contentOf(folder / "shaken/image_0/000000.png"));
  EXPECT_NE(test::contentOf(folder / "still/image_1/000000.png"),
            test::contentOf(folder / "shaken/image_1/000000.png"));
}

/// Compares rays with the shifts of a far point's observations, as rays are shifted where they are infinitely long.
TEST(SynthLens, PixelsOfBothCamerasTakeTheRaysThatObservationShiftsSay) {
  const StereoCamera camera = kittiCamera();
  CalibrationErrors errors;
  for (int k = 0; k < kCalibrationErrors; ++k) errors[k] = 0.3 * k - 1;
  const LensErrors left(camera, StereoSide::kLeft, errors), right(camera, StereoSide::kRight, errors);
  const Eigen::Vector3d uvd_px{1100, 320, 24};
  const Eigen::Vector3d exact_px =
      uvd_px + observationShifts(camera, CalibrationSigmas{}, uvd_px) *
                   Eigen::Map<const Eigen::Matrix<double, kCalibrationErrors, 1>>(errors.data());
  const auto of_left = left.exact(1100, 320), of_right = right.exact(1100 - 24, 320);
  EXPECT_NEAR(of_left.u_px, exact_px.x(), 1e-3);
  EXPECT_NEAR(of_left.v_px, exact_px.y(), 1e-3);
  const double by_baseline_px = CalibrationSigmas{}.baseline * errors[6] * uvd_px.z();
  EXPECT_NEAR(of_left.u_px - of_right.u_px, exact_px.z() + by_baseline_px, 1e-3);
}

TEST(SynthSequence, MoversCanBeLeftOut) {
  const Scene scene = makeScene("convoy", 1);
  const FrameScene with(scene, 3, true), without(scene, 3, false);
  EXPECT_EQ(with.placed().size() - without.placed().size(), scene.movers.size());
}

/// Two things by their ids, empty when none touch.
std::string touchingPair(const std::vector<Placed>& vehicles) {
  for (std::size_t i = 0; i < vehicles.size(); ++i)
    for (std::size_t j = 0; j < vehicles.size(); ++j)
      if (i != j && overlap(vehicles[i], vehicles[j], 0.1))
        return std::to_string(vehicles[i].id) + " and " + std::to_string(vehicles[j].id);
  return {};
}

TEST(SynthScenes, RoadUsersNeverTouch) {
  const auto ego_model = std::make_shared<Model>();
  ego_model->length_m = 4.2F;
  ego_model->width_m = 1.8F;
  for (const auto& name : sceneNames())
    for (const std::uint32_t seed : {1U, 2U, 3U}) {
      const Scene scene = makeScene(name, seed);
      for (int k = 0; k < scene.frames; k += 4) {
        const FrameScene frame(scene, k, true);
        Placed ego;
        ego.model = ego_model;
        ego.T_map_body = scene.ego.trajectory.T_map_body(scene.time_s(k));
        std::vector<Placed> vehicles{ego};
        for (const auto& object : frame.objects()) vehicles.push_back(object.front());
        ASSERT_EQ(touchingPair(vehicles), "") << name << " seed " << seed << " frame " << k;
      }
    }
}

TEST(SynthScenes, EverythingMovesSmoothly) {
  constexpr double kMaxAcceleration = 6, kMaxJerk = 25;  // m/s^2, m/s^3: hard driving, but no jumps
  for (const auto& name : sceneNames()) {
    const Scene scene = makeScene(name, 1);
    std::vector<Trajectory> trajectories{scene.ego.trajectory};
    for (const auto& mover : scene.movers) trajectories.push_back(mover.trajectory);
    for (const auto& trajectory : trajectories) {
      const auto acceleration = [&](double t) -> Eigen::Vector3d {
        constexpr double kH_s = 0.05;
        const auto p = [&](double at) { return trajectory.T_map_body(at).translation(); };
        return (p(t + kH_s) - 2 * p(t) + p(t - kH_s)) / (kH_s * kH_s);
      };
      for (double t = 0.1; t < scene.frames * scene.frame_s; t += 0.1) {
        EXPECT_LT(acceleration(t).norm(), kMaxAcceleration) << name << " at " << t;
        EXPECT_LT((acceleration(t + 0.05) - acceleration(t)).norm() / 0.05, kMaxJerk) << name << " at " << t;
      }
    }
  }
}

TEST(SynthScenes, TheCircuitHasNoSeam) {
  const Scene scene = makeScene("circuit", 2);
  ASSERT_GT(scene.lap_frames, 0);
  const StereoCamera camera = kittiCamera(124, 40);
  const FrameScene first(scene, 0, true), again(scene, scene.lap_frames, true);
  EXPECT_EQ(pixels(render(first, camera, StereoSide::kLeft, {}).image),
            pixels(render(again, camera, StereoSide::kLeft, {}).image));
  // From the last frame to the first one is a step like those around it, for the camera and for all vehicles.
  const auto step = [&](int from, std::size_t i) {
    const FrameScene a(scene, from, true), b(scene, from + 1, true);
    if (i == 0) return (a.T_map_cam().translation() - b.T_map_cam().translation()).norm();
    const std::size_t mover = a.placed().size() - i, moved = b.placed().size() - i;
    return (a.placed()[mover].T_map_body.translation() - b.placed()[moved].T_map_body.translation()).norm();
  };
  for (std::size_t i = 0; i <= scene.movers.size(); ++i) {
    const double before = step(scene.lap_frames - 2, i), across = step(scene.lap_frames - 1, i), after = step(0, i);
    EXPECT_NEAR(across, 0.5 * (before + after), 0.01) << i;  // m
  }
}

}  // namespace
}  // namespace motorcade::synth
