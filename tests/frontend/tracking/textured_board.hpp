#pragma once

#include <cmath>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "frontend/tracking/tracked_object.hpp"
#include "tests/frontend/texture.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade::test {

/// A textured board of 3 x 1.6 m, upright and square to the camera, which drives before a far wall with another
/// texture, in the images of the rig.
class TexturedBoard {
 public:
  static constexpr double kWall_m = 80, kHalfWidth_m = 1.5, kHalfHeight_m = 0.8;

  /// Body axes x ahead (the camera's z), y left, z up; its origin is the middle of the board.
  static SE3 standingAt(double x_m, double z_m) {
    Eigen::Matrix3d upright;
    upright << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    return {upright, {x_m, 0.5, z_m}};
  }
  static FeaturesPtr seenAt(const SE3& T_cam_body, bool there = true) {
    return there ? seen({{T_cam_body, paint}}) : seen({});
  }
  /// Gray level at so many meters to the right of and below the middle of a board; empty beside the board.
  using Paint = std::function<std::optional<double>(double right_m, double down_m)>;
  static std::optional<double> paint(double right_m, double down_m) {
    if (std::abs(right_m) > kHalfWidth_m || std::abs(down_m) > kHalfHeight_m) return std::nullopt;
    return texture(right_m, down_m);
  }
  /// A board with the size of a person.
  static std::optional<double> person(double right_m, double down_m) {
    if (std::abs(right_m) > 0.3 || std::abs(down_m) > 0.9) return std::nullopt;
    return texture(right_m, down_m);
  }
  static double texture(double right_m, double down_m) {
    constexpr double kPixelsPerMeter = 60;
    return kTexture(kPixelsPerMeter * right_m, kPixelsPerMeter * down_m);
  }
  /// Boards before the wall, of which the first hides those behind it.
  struct Painted {
    SE3 T_cam_body;
    Paint paint;
  };
  static FeaturesPtr seen(const std::vector<Painted>& boards) {
    auto features = std::make_shared<Features>();
    features->frame = std::make_shared<const StereoFrame>();
    features->left.levels.push_back(view(boards, 0));
    features->right.levels.push_back(view(boards, kRig.baseline_m));
    return features;
  }
  /// `count` points on the board, as they are measured without error, numbered from `first` on.
  static std::vector<ScenePoint> points(const SE3& T_cam_body, int count, std::int64_t first) {
    std::vector<ScenePoint> points;
    Noise noise(3);
    for (std::int64_t i = 0; i < count; ++i) {
      const Eigen::Vector3d p_body = noise.inBox({0, -1.2, -0.6}, {0, 1.2, 0.6});
      points.push_back({.point = {first + i},
                        .uvd_px = *kRig.project(T_cam_body * p_body),
                        .sigma_px = kObservationSigma_px,
                        .flow = {}});
    }
    return points;
  }

 private:
  inline static const Texture kTexture{1};

  static Image view(const std::vector<Painted>& boards, double camera_x_m) {
    return render(kRig.width_px, kRig.height_px, [&](double u, double v) {
      const double x = (u - kRig.cx_px) / kRig.fx_px, y = (v - kRig.cy_px) / kRig.fy_px;
      for (const Painted& board : boards) {
        const Eigen::Vector3d& middle = board.T_cam_body.translation();
        if (const auto gray = board.paint(x * middle.z() + camera_x_m - middle.x(), y * middle.z() - middle.y()))
          return *gray;
      }
      return 128 + 40 * std::sin(0.9 * (u + kRig.fx_px * camera_x_m / kWall_m)) * std::sin(0.7 * v);
    });
  }
};

}  // namespace motorcade::test
