#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>

#include "io/images/image_file.hpp"
#include "io/layouts/open_sequence.hpp"
#include "io/results/run_folder.hpp"
#include "io/rig/lens_camera.hpp"
#include "io/rig/rectification.hpp"
#include "io/sequence/sequence.hpp"
#include "tests/apps/program_run.hpp"
#include "tests/support/data_folder.hpp"

/// Tests runs whose cameras the user states, or that are rectified on the way.
namespace motorcade::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A rig that might have taken the rendered drive: both cameras turned and behind lenses that distort.
struct BentRig {
  LensCamera lens;
  Eigen::Matrix3d R_left_raw, R_right_raw;  // p_rectified = R * p_raw
};

BentRig bentRig(const StereoCamera& camera) {
  return {.lens = {.fx_px = 0.8 * camera.fx_px,
                   .fy_px = 0.8 * camera.fy_px,
                   .cx_px = camera.cx_px + 5,
                   .cy_px = camera.cy_px - 3,
                   .distortion = Distortion::kRadialTangential,
                   .coefficients = {-0.25, 0.06, 0.0005, -0.0003}},
          .R_left_raw = expSO3({0.01, -0.006, 0.012}),
          .R_right_raw = expSO3({-0.008, 0.009, -0.01})};
}

/// Place in the rectified image of each pixel that a camera of the rig would have taken; beyond it, at its edge.
std::vector<Eigen::Vector2d> sourcesOf(const StereoCamera& camera, const LensCamera& lens, const Eigen::Matrix3d& R) {
  const LensModel model(lens);
  const auto clamped = [](double value, int size) { return std::clamp<double>(value, 0, size - 1.001); };
  std::vector<Eigen::Vector2d> sources;
  for (int v = 0; v < camera.height_px; ++v)
    for (int u = 0; u < camera.width_px; ++u) {
      const Eigen::Vector3d ray = R * model.rayThrough(Eigen::Vector2d(u, v)).value();
      sources.emplace_back(clamped(camera.fx_px * ray.x() / ray.z() + camera.cx_px, camera.width_px),
                           clamped(camera.fy_px * ray.y() / ray.z() + camera.cy_px, camera.height_px));
    }
  return sources;
}

Image bent(const Image& rectified, const std::vector<Eigen::Vector2d>& sources, ImagePool& pool) {
  Image raw = pool.acquire(rectified.width(), rectified.height());
  auto source = sources.begin();
  for (int v = 0; v < raw.height(); ++v)
    for (int u = 0; u < raw.width(); ++u, ++source) {
      const int left = static_cast<int>(source->x()), top = static_cast<int>(source->y());
      const double right = source->x() - left, down = source->y() - top;
      const double mean = (1 - down) * ((1 - right) * rectified.at(left, top) + right * rectified.at(left + 1, top)) +
                          down * ((1 - right) * rectified.at(left, top + 1) + right * rectified.at(left + 1, top + 1));
      raw.mutableRow(v)[u] = static_cast<std::uint8_t>(std::lround(mean));
    }
  return raw;
}

std::string listOf(const Eigen::Matrix3d& matrix) {
  std::ostringstream text;
  text.precision(17);
  for (int i = 0; i < 9; ++i) text << (i > 0 ? ", " : "[") << matrix(i / 3, i % 3);
  text << ']';
  return text.str();
}

class RunInputs : public Run {
 protected:
  /// The rendered drive as the bent rig takes it, in folders left and right, and OpenCV's file of it elsewhere.
  fs::path bentDrive() {
    const Sequence drive = openSequence(kSequence);
    const BentRig rig = bentRig(drive.camera);
    fs::path folder = out("bent");
    ImagePool pool;
    for (const StereoSide side : {StereoSide::kLeft, StereoSide::kRight}) {
      const bool left = side == StereoSide::kLeft;
      const fs::path images = folder / (left ? "left" : "right");
      fs::create_directories(images);
      const auto sources = sourcesOf(drive.camera, rig.lens, left ? rig.R_left_raw : rig.R_right_raw);
      for (const FramePaths& frame : drive.frames)
        writePng(images / frame.left.filename(), bent(readImage(frame.of(side), pool), sources, pool));
    }
    const Eigen::Matrix3d K =
        (Eigen::Matrix3d() << rig.lens.fx_px, 0, rig.lens.cx_px, 0, rig.lens.fy_px, rig.lens.cy_px, 0, 0, 1).finished();
    const Eigen::Vector3d t = rig.R_right_raw.transpose() * Eigen::Vector3d(-drive.camera.baseline_m, 0, 0);
    std::ofstream file(calibration());
    file.precision(17);
    file << "M1: " << listOf(K) << "\nM2: " << listOf(K) << "\nD1: [-0.25, 0.06, 0.0005, -0.0003]\n"
         << "D2: [-0.25, 0.06, 0.0005, -0.0003]\nR: " << listOf(rig.R_right_raw.transpose() * rig.R_left_raw)
         << "\nT: [" << t.x() << ", " << t.y() << ", " << t.z() << "]\n";
    fs::copy(kSequence / "times.txt", folder / "times.txt");
    return folder;
  }
  fs::path calibration() const { return out("rig.yml"); }
};

TEST_F(RunInputs, PairsBehindLensesAreFollowedLikeRectifiedOnes) {
  const fs::path drive = bentDrive();
  EXPECT_EQ(motorcade("check " + drive.string() + " --camera 700,700,620,187,0.5"), 3) << contentOf(out("stdout"));
  ASSERT_EQ(motorcade("check " + drive.string() + " --calibration " + calibration().string()), 0)
      << contentOf(out("stdout"));
  EXPECT_THAT(contentOf(out("stdout")), Not(HasSubstr("between the rows")));
  ASSERT_EQ(run("bent", "--calibration " + calibration().string() + " --require tracked=0.9", drive), 0)
      << contentOf(errors());
  EXPECT_THAT(contentOf(errors()), AllOf(HasSubstr("rectified on the way to fx"), HasSubstr("baseline 0.5")));
  EXPECT_EQ(summary("bent")["calibration"], calibration().string());

  // The camera is turned against that of the drive, so that positions alone tell.
  ASSERT_EQ(run("rendered"), 0) << contentOf(errors());
  const auto bent_way = readRunFolder(out("bent")).final.camera, way = readRunFolder(out("rendered")).final.camera;
  ASSERT_EQ(bent_way.size(), way.size());
  const double length_m = way.back().translation().norm();
  EXPECT_NEAR(bent_way.back().translation().norm(), length_m, 0.01 * length_m);

  ASSERT_EQ(motorcade("draw " + out("bent").string() + " --out " + out("pictures").string() + " --every 13"), 0)
      << contentOf(errors());
  EXPECT_TRUE(fs::exists(out("pictures") / "frame_000000.png"));
  fs::remove(calibration());
  EXPECT_EQ(motorcade("draw " + out("bent").string() + " --out " + out("pictures").string()), 3);
  EXPECT_THAT(contentOf(errors()), HasSubstr("rig.yml"));
}

TEST_F(RunInputs, GivenCameraOfAListIsRememberedByTheRun) {
  const Sequence drive = openSequence(kSequence);
  std::ofstream list(out("list.txt"));
  for (const FramePaths& frame : drive.frames) list << frame.left.string() << ' ' << frame.right.string() << '\n';
  list.close();
  std::ostringstream camera;
  camera.precision(17);
  camera << drive.camera.fx_px << ',' << drive.camera.fy_px << ',' << drive.camera.cx_px << ',' << drive.camera.cy_px
         << ',' << drive.camera.baseline_m;
  std::string exact;  // as the folder's calibration says that it is
  for (const char* key : {"focal", "middle_px", "distortion", "baseline", "disparity_px"})
    exact += std::string(" --set calibration.") + key + "=0";
  ASSERT_EQ(run("list", "--camera " + camera.str() + exact, out("list.txt")), 0) << contentOf(errors());
  ASSERT_EQ(run("folder"), 0) << contentOf(errors());
  expectSame("list", "folder");
  EXPECT_EQ(summary("list")["camera"], camera.str());
  EXPECT_EQ(motorcade("draw " + out("list").string() + " --out " + out("pictures").string() + " --frames 0:1"), 0)
      << contentOf(errors());
  EXPECT_EQ(run("both", "--camera 1,1,1,1,1 --calibration x", out("list.txt")), 2);
}

TEST_F(RunInputs, CalibrationInForceIsInTheFirstLineAndInTheSummary) {
  ASSERT_EQ(run("rendered", "--frames 0:4"), 0) << contentOf(errors());
  const std::string file = (fs::absolute(kSequence) / "calib.txt").lexically_normal().string();
  const std::string first_line = contentOf(errors()).substr(0, contentOf(errors()).find('\n'));
  EXPECT_THAT(first_line, HasSubstr("calibration " + file));
  EXPECT_EQ(summary("rendered")["calibration"], file);
  EXPECT_EQ(summary("rendered")["calibration_from"], "sequence");
  EXPECT_EQ(motorcade("check " + kSequence.string()), 0);
  EXPECT_THAT(contentOf(out("stdout")).substr(0, contentOf(out("stdout")).find('\n')),
              HasSubstr("calibration " + file));
  ASSERT_EQ(run("given", "--frames 0:4 --calibration " + kSequence.string()), 0) << contentOf(errors());
  EXPECT_THAT(contentOf(errors()), HasSubstr(file + " (--calibration)"));
  EXPECT_EQ(summary("given")["calibration_from"], "option");
  expectSame("rendered", "given");
}

TEST_F(RunInputs, MiddlesThatDifferGiveTheSameWayAsOneMiddle) {
  const fs::path folder = out("moved");
  const Sequence drive = openSequence(kSequence);
  ImagePool pool;
  constexpr int kMoved_px = 20;
  for (const FramePaths& frame : drive.frames) {
    const Image right = readImage(frame.right, pool);
    Image moved = pool.acquire(right.width(), right.height());
    for (int v = 0; v < right.height(); ++v)
      for (int u = 0; u < right.width(); ++u)
        moved.mutableRow(v)[u] = right.at(std::min(u + kMoved_px, right.width() - 1), v);
    fs::create_directories(folder / "left");
    fs::create_directories(folder / "right");
    fs::copy(frame.left, folder / "left" / frame.left.filename());
    writePng(folder / "right" / frame.left.filename(), moved);
  }
  fs::copy(kSequence / "times.txt", folder / "times.txt");
  std::ofstream calibration(folder / "calib.txt");
  calibration.precision(17);
  const StereoCamera& c = drive.camera;
  for (const bool left : {true, false})
    calibration << (left ? "P0: " : "P1: ") << c.fx_px << " 0 " << c.cx_px - (left ? 0 : kMoved_px) << ' '
                << (left ? 0 : -c.fx_px * c.baseline_m) << " 0 " << c.fy_px << ' ' << c.cy_px << " 0 0 0 1 0\n";
  calibration.close();
  ASSERT_EQ(run("moved", "--require tracked=0.9", folder), 0) << contentOf(errors());
  ASSERT_EQ(run("rendered"), 0) << contentOf(errors());
  const double way_m = readRunFolder(out("rendered")).final.camera.back().translation().norm();
  const SE3 moved = readRunFolder(out("moved")).final.camera.back(),
            same = readRunFolder(out("rendered")).final.camera.back();
  EXPECT_LT((moved.translation() - same.translation()).norm(), 0.005 * way_m);
}

TEST_F(RunInputs, WrongCalibrationsEndTheRunBeforeItsFirstFrame) {
  const fs::path drive = out("drive");
  fs::create_directories(drive);
  for (const char* side : {"left", "right"})
    fs::create_directory_symlink(fs::absolute(kSequence) / (std::string(side) == "left" ? "image_0" : "image_1"),
                                 drive / side);
  const auto refused = [&](const std::string& name, const std::string& content) {
    std::ofstream(drive / name) << content;
    EXPECT_EQ(run("refused", "", drive), 3) << content;
    EXPECT_FALSE(fs::exists(out("refused") / "summary.json"));
    fs::remove(drive / name);
    return contentOf(errors());
  };
  EXPECT_THAT(refused("calib.txt", "K: 721.5 0 620.5 0 721.5 187.0 0 0 1\n"), HasSubstr("has no P0 and P1"));
  EXPECT_THAT(refused("calib.txt", "p0: 1\np1: 2\n"), HasSubstr("has no P0 and P1"));
  const std::string lenses = "K1: [700, 0, 620, 0, 700, 187, 0, 0, 1]\nK2: [700, 0, 620, 0, 700, 187, 0, 0, 1]\n";
  EXPECT_THAT(refused("stereo.yml", lenses + "D1: [-0.006, 0.04, -0.04, 0.007]\nD2: [-0.005, 0.04, -0.04, 0.007]\n"
                                             "R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nT: [-0.5, 0, 0]\n"),
              HasSubstr("distortion_model: equidistant"));
  EXPECT_THAT(refused("stereo.yml", lenses + "D1: [0, 0, 0, 0, 0]\nD2: [0, 0, 0, 0, 0]\n"
                                             "R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nT: [0.5, 0, 0]\n"),
              HasSubstr("inverse of what is meant"));
}

TEST_F(RunInputs, RigHeldStillInARoomIsReportedAsStandingStill) {
  const fs::path drive = dataFolder() / "euroc_v101";
  if (!fs::exists(drive)) GTEST_SKIP() << drive << " is not there";
  EXPECT_EQ(motorcade("check " + drive.string()), 0) << contentOf(out("stdout"));
  EXPECT_THAT(contentOf(out("stdout")), HasSubstr("nothing is wrong"));
  ASSERT_EQ(run("euroc", "--require tracked=1", drive), 0) << contentOf(errors());
  const RunFolder folder = readRunFolder(out("euroc"));
  EXPECT_THAT(folder.online.objects, IsEmpty());
  EXPECT_THAT(folder.final.objects, IsEmpty());
  constexpr double kDrift_m = 0.05;
  for (const SE3& T_world_cam : folder.final.camera) EXPECT_LT(T_world_cam.translation().norm(), kDrift_m);
  EXPECT_LT(evaluate("euroc", drive)["final"]["camera"]["ate_m"]["rmse"], 0.005);
}

}  // namespace
}  // namespace motorcade::test
