#include <algorithm>
#include <array>
#include <filesystem>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "apps/interface/camera_model.hpp"
#include "io/layouts/open_sequence.hpp"
#include "io/rig/rectification.hpp"
#include "io/rig/remap.hpp"
#include "io/sequence/sequence.hpp"
#include "tests/interface/tracked_drive.hpp"
#include "tests/support/data_folder.hpp"

/// Tests that a pair rectified inside gives the same as one that was rectified before.
namespace motorcade {
namespace {

std::array<double, 12> rowsOf(const SE3& T) {
  std::array<double, 12> rows{};
  Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> matrix(rows.data());
  matrix << T.rotation(), T.translation();
  return rows;
}

/// The rig as the readers of calibrations know it.
Rig rigOf(const Camera& camera) {
  const auto lens = [&](const Camera::Lens& l) {
    return LensCamera{.fx_px = l.fx_px,
                      .fy_px = l.fy_px,
                      .cx_px = l.cx_px,
                      .cy_px = l.cy_px,
                      .distortion = l.distortion == Camera::Distortion::kNone          ? Distortion::kNone
                                    : l.distortion == Camera::Distortion::kEquidistant ? Distortion::kEquidistant
                                                                                       : Distortion::kRadialTangential,
                      .coefficients = l.coefficients,
                      .size = {camera.width_px, camera.height_px}};
  };
  const Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> T(camera.rig->T_right_left.data());
  return {.file = "rig",
          .left = lens(camera.rig->left),
          .right = lens(camera.rig->right),
          .T_right_left = SE3(T.leftCols<3>(), T.col(3)).normalized()};
}

/// The drive as it is after `io/rig` has rectified it.
DriveInMemory rectified(const DriveInMemory& raw) {
  const ImageSize size{raw.camera.width_px, raw.camera.height_px};
  const Rectification rectification = rectificationOf(rigOf(raw.camera), size);
  const Remap left(rectification.left, rectification.R_left, rectification.camera, size),
      right(rectification.right, rectification.R_right, rectification.camera, size);
  ImagePool pool;
  const auto through = [&](const Remap& remap, const std::vector<std::uint8_t>& pixels) {
    Image image = pool.acquire(size.width, size.height);
    for (int y = 0; y < size.height; ++y)
      std::copy_n(&pixels[std::size_t(y) * std::size_t(size.width)], size.width, image.mutableRow(y));
    const Image turned = remap(image, pool);
    return pixelsOf({.pixels = turned.data(),
                     .width_px = turned.width(),
                     .height_px = turned.height(),
                     .stride_bytes = turned.stride()});
  };
  DriveInMemory drive{.camera = cameraOf(rectification.camera, {}), .frames = {}};
  drive.camera.sigmas = raw.camera.sigmas;
  for (const auto& frame : raw.frames)
    drive.frames.push_back({through(left, frame.left), through(right, frame.right), frame.stamp_ns});
  return drive;
}

/// Compares frames that are good in the end, so that something was compared.
void expectTheSame(const DriveInMemory& raw) {
  const std::vector<Result> before = track(rectified(raw)), inside = track(raw);
  EXPECT_EQ(bytesOf(inside), bytesOf(before));
  ASSERT_EQ(inside.size(), raw.frames.size());
  EXPECT_EQ(inside.back().status, Result::Status::kGood);
}

/// The rendered pictures as if taken by distorting lenses: the world is bent then, and is so in both.
DriveInMemory asIfDistorted(Camera::Distortion distortion) {
  DriveInMemory drive = readDrive(MOTORCADE_SMALL_SEQUENCE);
  const auto lens = [&](double scale) {
    return Camera::Lens{.fx_px = scale * drive.camera.fx_px,
                        .fy_px = drive.camera.fy_px,
                        .cx_px = drive.camera.cx_px,
                        .cy_px = drive.camera.cy_px,
                        .distortion = distortion,
                        .coefficients = {-0.02 * scale, 0.003, 0, 0}};
  };
  constexpr double kTurn_rad = 0.001;
  drive.camera.rig = {
      .left = lens(1),
      .right = lens(1.002),
      .T_right_left =
          rowsOf(SE3::exp((Vector6d() << -drive.camera.baseline_m, 0.001, 0.002, 0, kTurn_rad, 0).finished()))};
  drive.camera.fx_px = drive.camera.baseline_m = 0;  // are not read
  return drive;
}

TEST(TrackerRig, RectifiesRadialTangentialLensesAsIfBeforehand) {
  expectTheSame(asIfDistorted(Camera::Distortion::kRadialTangential));
}

TEST(TrackerRig, RectifiesEquidistantLensesAsIfBeforehand) {
  expectTheSame(asIfDistorted(Camera::Distortion::kEquidistant));
}

/// The rig of the Vicon room's recordings, with the numbers of its two sensor.yaml.
Camera viconRoomCamera() {
  Camera camera{.width_px = 752, .height_px = 480};
  const Eigen::Matrix4d T_body_left{{0.0148655429818, -0.999880929698, 0.00414029679422, -0.0216401454975},
                                    {0.999557249008, 0.0149672133247, 0.025715529948, -0.064676986768},
                                    {-0.0257744366974, 0.00375618835797, 0.999660727178, 0.00981073058949},
                                    {0, 0, 0, 1}};
  const Eigen::Matrix4d T_body_right{{0.0125552670891, -0.999755099723, 0.0182237714554, -0.0198435579556},
                                     {0.999598781151, 0.0130119051815, 0.0251588363115, 0.0453689425024},
                                     {-0.0253898008918, 0.0179005838253, 0.999517347078, 0.00786212447038},
                                     {0, 0, 0, 1}};
  const Eigen::Matrix4d T_right_left = T_body_right.inverse() * T_body_left;
  camera.rig = {.left = {.fx_px = 458.654,
                         .fy_px = 457.296,
                         .cx_px = 367.215,
                         .cy_px = 248.375,
                         .distortion = Camera::Distortion::kRadialTangential,
                         .coefficients = {-0.28340811, 0.07395907, 0.00019359, 1.76187114e-05}},
                .right = {.fx_px = 457.587,
                          .fy_px = 456.134,
                          .cx_px = 379.999,
                          .cy_px = 255.238,
                          .distortion = Camera::Distortion::kRadialTangential,
                          .coefficients = {-0.28368365, 0.07451284, -0.00010473, -3.55590700e-05}}};
  Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(camera.rig->T_right_left.data()) = T_right_left.topRows<3>();
  return camera;
}

TEST(TrackerRig, RectifiesARealRigAsIfBeforehand) {
  const auto folder = test::dataFolder() / "euroc_v101";
  if (!exists(folder)) GTEST_SKIP() << folder << " is not there";
  const Sequence sequence = openSequence(folder);
  DriveInMemory raw{.camera = viconRoomCamera(), .frames = {}};
  ImagePool pool;
  const auto read = [&](const std::filesystem::path& file) {
    const Image image = readImage(file, pool);
    return pixelsOf({.pixels = image.data(),
                     .width_px = image.width(),
                     .height_px = image.height(),
                     .stride_bytes = image.stride()});
  };
  constexpr std::size_t kFrames = 8;
  for (std::size_t i = 0; i < kFrames; ++i)
    raw.frames.push_back({read(sequence.frames[i].left), read(sequence.frames[i].right), sequence.stamps[i].ns});
  expectTheSame(raw);
  // What the reader of the recording makes of its files is the same rig.
  const StereoCamera& read_camera = sequence.camera;
  const Camera ours = rectified(raw).camera;
  constexpr double kTol_px = 1e-3;  // of printed digits
  EXPECT_NEAR(ours.fx_px, read_camera.fx_px, kTol_px);
  EXPECT_NEAR(ours.cx_px, read_camera.cx_px, kTol_px);
  EXPECT_NEAR(ours.cy_px, read_camera.cy_px, kTol_px);
  EXPECT_NEAR(ours.baseline_m, read_camera.baseline_m, 1e-6);
}

/// The drive to and fro, long enough for the rig to be judged.
DriveInMemory toAndFro(DriveInMemory drive) {
  constexpr std::int64_t kPeriod_ns = 100'000'000;
  const auto there = drive.frames;
  drive.frames.insert(drive.frames.end(), there.rbegin() + 1, there.rend());
  for (std::size_t i = 0; i < drive.frames.size(); ++i)
    drive.frames[i].stamp_ns = static_cast<std::int64_t>(i) * kPeriod_ns;
  return drive;
}

TEST(WatchedRig, ALogAndTheResultsTellOfImagesThatAreExchanged) {
  DriveInMemory drive = toAndFro(readDrive(MOTORCADE_SMALL_SEQUENCE));
  for (const bool exchanged : {false, true}) {
    if (exchanged)
      for (auto& frame : drive.frames) std::swap(frame.left, frame.right);
    std::mutex mutex;
    std::string log;
    Tracker::Options options = replay();
    options.log = [&](Tracker::LogLevel, const std::string& line) {
      const std::scoped_lock lock(mutex);
      log += line + "\n";
    };
    const std::vector<Result> results = track(drive, options);
    ASSERT_EQ(results.size(), drive.frames.size());
    EXPECT_EQ(log.find("the rig: left and right image are exchanged") != std::string::npos, exchanged) << log;
    EXPECT_EQ(results.back().problem.find("are exchanged") != std::string::npos, exchanged) << results.back().problem;
    EXPECT_TRUE(exchanged || log.find("the rig: ") == std::string::npos) << log;
  }
}

}  // namespace
}  // namespace motorcade
