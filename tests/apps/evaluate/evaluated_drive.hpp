#pragma once

#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "apps/evaluate/measures/evaluation.hpp"
#include "io/images/image_file.hpp"
#include "io/results/run_folder.hpp"
#include "io/truth/trajectory.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade::test {

/// A drive made by hand: the camera goes 1 m per frame; label 7 goes 1.2 m ahead of it per frame, label 8 is parked.
/// The rows' bodies sit elsewhere in the cars and have other axes than the labels.
class EvaluateDrive : public testing::Test {
 protected:
  static constexpr int kFrames = 30;

  EvaluateDrive() {
    ImagePool pool;
    Image image = pool.acquire(64, 32);
    std::string poses, labels;
    for (const char* side : {"image_0", "image_1"}) std::filesystem::create_directories(folder_ / "drive" / side);
    for (int i = 0; i < kFrames; ++i) {
      std::string name = std::to_string(100 + i) + ".png";
      writePng(folder_ / "drive/image_0" / name, image);
      writePng(folder_ / "drive/image_1" / name, image);
      poses += kittiLine(camera(i)) + "\n";
      char line[256];
      for (const auto& [id, z] : {std::pair(7, 15 + 1.2 * i - i), std::pair(8, 60.0 - i)}) {
        std::snprintf(line, sizeof(line), "%d %d Car 0 0 0 10 10 40 60 1.5 1.7 4.2 %.6f 1.6 %.6f -1.570796\n", i, id,
                      id == 7 ? 2.0 : -4.0, z);
        labels += line;
      }
    }
    folder_.write("drive/calib.txt", "P0: 700 0 32 0 0 700 16 0 0 0 1 0\nP1: 700 0 32 -350 0 700 16 0 0 0 1 0\n");
    folder_.write("drive/poses.txt", poses);
    folder_.write("drive/label_02.txt", labels);
    options_.run = folder_ / "run";
    options_.sequence = folder_ / "drive";
  }

  static SE3 camera(int i) { return SE3(Eigen::Matrix3d::Identity(), {0, 0, static_cast<double>(i)}); }
  static ObjectEstimate lead(int i, int track) {
    Eigen::Matrix3d world_body;
    world_body << 0, -1, 0, 0, 0, -1, 1, 0, 0;  // x ahead, z up
    ObjectEstimate object;
    object.track = {track};
    object.T_world_body = SE3(world_body, {2.3, 1.0, 15 + 1.2 * i + 1.0});
    object.velocity_world_mps = {0, 0, 12};
    object.speed_sigma_mps = 0.1;
    object.points = 20;
    object.box = {10, 10, 40, 60};
    object.covariance = Matrix6d::Identity() * 1e-4;
    return object;
  }
  /// Writes a run over frames [first, end), with `change` applied to each estimate.
  template <class Change>
  void writeRun(const std::filesystem::path& name, int first, int end, const Change& change) {
    RunFolderWriter writer(folder_ / name);
    for (int i = first; i < end; ++i) {
      FrameEstimate estimate;
      estimate.head.frame = {i};
      estimate.head.stamp = {i * 100'000'000LL};
      const SE3 T_first = camera(first).inverse();
      estimate.T_world_cam = T_first * camera(i);
      estimate.objects.push_back(lead(i, 3));
      estimate.camera_covariances = {.motion = Matrix6d::Identity() * 1e-4, .pose = Matrix6d::Identity() * 1e-4};
      change(i, estimate);
      for (auto& object : estimate.objects) object.T_world_body = T_first * object.T_world_body;
      FrameTiming timing;
      timing.head.frame = estimate.head.frame;
      timing.head.stamp = estimate.head.stamp;
      writer.writeOnline(estimate);
      writer.writeTiming(timing);
      writer.writeFinal(estimate);
    }
    writer.finish("{}");
  }

  TemporaryFolder folder_;
  EvaluateOptions options_;
};

}  // namespace motorcade::test
