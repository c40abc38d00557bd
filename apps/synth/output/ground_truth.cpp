#include "apps/synth/output/ground_truth.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include <fmt/format.h>

namespace motorcade::synth {
namespace {

Eigen::Vector3d toDouble(const Vec3& v) { return {v.x, v.y, v.z}; }

struct ImageBox {
  double left = 1e9, top = 1e9, right = -1e9, bottom = -1e9;
  void include(const Eigen::Vector3d& p_cam, const StereoCamera& camera) {
    const double u = camera.fx_px * p_cam.x() / p_cam.z() + camera.cx_px,
                 v = camera.fy_px * p_cam.y() / p_cam.z() + camera.cy_px;
    left = std::min(left, u);
    right = std::max(right, u);
    top = std::min(top, v);
    bottom = std::max(bottom, v);
  }
};

/// Includes the box of a convex hull's projection. If the hull passes the image plane, only its part ahead counts.
void includeHull(ImageBox& box, const std::vector<Eigen::Vector3d>& hull, const StereoCamera& camera) {
  constexpr double kNear_m = 0.05;
  const bool cut = std::any_of(hull.begin(), hull.end(), [](const auto& p) { return p.z() < kNear_m; });
  for (std::size_t i = 0; i < hull.size(); ++i) {
    if (hull[i].z() >= kNear_m) box.include(hull[i], camera);
    for (std::size_t k = i + 1; cut && k < hull.size(); ++k) {
      if ((hull[i].z() < kNear_m) == (hull[k].z() < kNear_m)) continue;
      box.include(hull[i] + (kNear_m - hull[i].z()) / (hull[k].z() - hull[i].z()) * (hull[k] - hull[i]), camera);
    }
  }
}

ImageBox projectedBox(std::span<const Placed> object, const SE3& T_cam_map, const StereoCamera& camera) {
  ImageBox box;
  std::vector<Eigen::Vector3d> hull;
  for (const Placed& placed : object) {
    const SE3 T_cam_body = T_cam_map * placed.T_map_body;
    for (const auto& part : placed.model->parts) {
      hull.clear();
      for (const Vec3& p : hullPoints(part, placed.model->cuts.data())) hull.push_back(T_cam_body * toDouble(p));
      includeHull(box, hull, camera);
    }
  }
  return box;
}

/// Share of a grid of points in the object's box that lies outside of the image.
double truncationOf(const Model& model, const SE3& T_cam_body, const StereoCamera& camera) {
  constexpr int kLong = 16, kWide = 6, kHigh = 5;
  int outside = 0;
  for (int i = 0; i < kLong; ++i)
    for (int j = 0; j < kWide; ++j)
      for (int k = 0; k < kHigh; ++k) {
        const auto share = [](int n, int of) { return (n + 0.5) / of; };
        const Eigen::Vector3d p_body((share(i, kLong) - 0.5) * model.length_m, (share(j, kWide) - 0.5) * model.width_m,
                                     share(k, kHigh) * model.height_m);
        const auto uvd = camera.project(T_cam_body * p_body);
        if (!uvd || !camera.inLeftImage(uvd->x(), uvd->y(), -0.5)) ++outside;
      }
  return static_cast<double>(outside) / (kLong * kWide * kHigh);
}

/// Visible pixels and the pixels that the object alone would cover, counted on the same grid.
struct Coverage {
  int visible = 0, alone = 0, visible_on_grid = 0;
};
Coverage coverageOf(const FrameScene& frame, std::span<const Placed> object, const StereoCamera& camera,
                    const Rendering& left, const Label& label) {
  const auto& R = frame.T_map_cam().rotation();
  const auto x0 = static_cast<int>(std::ceil(label.left_px)), x1 = static_cast<int>(std::floor(label.right_px));
  const auto y0 = static_cast<int>(std::ceil(label.top_px)), y1 = static_cast<int>(std::floor(label.bottom_px));
  const int step =
      std::max(1, static_cast<int>(std::sqrt(static_cast<double>(std::max(0, x1 - x0)) * std::max(0, y1 - y0)) / 60));
  Coverage count;
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const bool seen = left.object[y * camera.width_px + x] == object.front().id;
      count.visible += seen ? 1 : 0;
      if ((x - x0) % step != 0 || (y - y0) % step != 0) continue;
      const Eigen::Vector3d d =
          R * Eigen::Vector3d((x - camera.cx_px) / camera.fx_px, (y - camera.cy_px) / camera.fy_px, 1);
      const Vec3 direction{static_cast<float>(d.x()), static_cast<float>(d.y()), static_cast<float>(d.z())};
      if (!seen && !FrameScene::meets(object, direction)) continue;
      ++count.alone;
      count.visible_on_grid += seen ? 1 : 0;
    }
  return count;
}

std::optional<Label> labelOf(const FrameScene& frame, std::span<const Placed> object, const StereoCamera& camera,
                             const Rendering& left, int min_pixels) {
  const Placed& placed = object.front();
  const SE3 T_cam_map = frame.T_map_cam().inverse(), T_cam_body = T_cam_map * placed.T_map_body;
  const Model& model = *placed.model;
  if (T_cam_body.translation().z() < -0.5 * model.length_m) return std::nullopt;
  const ImageBox box = projectedBox(object, T_cam_map, camera);
  Label label;
  label.id = placed.id;
  label.type = model.kitti_type;
  label.left_px = std::clamp(box.left, 0.0, camera.width_px - 1.0);
  label.right_px = std::clamp(box.right, 0.0, camera.width_px - 1.0);
  label.top_px = std::clamp(box.top, 0.0, camera.height_px - 1.0);
  label.bottom_px = std::clamp(box.bottom, 0.0, camera.height_px - 1.0);
  if (box.left > box.right || label.left_px >= label.right_px || label.top_px >= label.bottom_px) return std::nullopt;
  const Coverage coverage = coverageOf(frame, object, camera, left, label);
  if (coverage.visible < min_pixels) return std::nullopt;
  const double visible = static_cast<double>(coverage.visible_on_grid) / std::max(1, coverage.alone);
  label.occluded = visible >= 0.8 ? 0 : visible >= 0.4 ? 1 : 2;
  label.truncated = truncationOf(model, T_cam_body, camera);
  label.height_m = model.height_m;
  label.width_m = model.width_m;
  label.length_m = model.length_m;
  label.location_cam = T_cam_body.translation();
  const Eigen::Vector3d ahead = T_cam_body.rotation().col(0);
  label.rotation_y_rad = std::atan2(-ahead.z(), ahead.x());
  label.alpha_rad =
      std::remainder(label.rotation_y_rad - std::atan2(label.location_cam.x(), label.location_cam.z()), 2 * M_PI);
  return label;
}

constexpr double kSample_s = 0.02, kDelay_s = 0.02;
constexpr double kScale = 0.02, kBias_radps = 0.3 * std::numbers::pi / 180;  // the most
constexpr double kSpeedNoise_mps = 0.03, kYawRateNoise_radps = 0.002;
constexpr double kSpin_s = 0.6, kSpin_mps = 2;
constexpr double kRearAxle_m = 1.3;  // behind the middle of the car

struct Motion {
  double speed_mps, yaw_rate_radps;
};

Motion motionAt(const Trajectory& car, double t_s) {
  constexpr double kStep_s = 0.005;
  const SE3 middle_rear(Eigen::Matrix3d::Identity(), {-kRearAxle_m, 0, 0});
  const SE3 before = car.T_map_body(t_s - kStep_s) * middle_rear, after = car.T_map_body(t_s + kStep_s) * middle_rear;
  const Vector6d step = (before.inverse() * after).log();
  return {step[0] / (2 * kStep_s), step[5] / (2 * kStep_s)};
}

}  // namespace

std::vector<Label> labelsOf(const FrameScene& frame, const StereoCamera& camera, const Rendering& left,
                            int min_pixels) {
  std::vector<Label> labels;
  for (const auto& object : frame.objects())
    if (auto label = labelOf(frame, object, camera, left, min_pixels)) labels.push_back(std::move(*label));
  std::sort(labels.begin(), labels.end(), [](const Label& a, const Label& b) { return a.id < b.id; });
  return labels;
}

std::string labelLine(int frame, const Label& l) {
  return fmt::format(
      "{} {} {} {:.2f} {} {:.6f} {:.2f} {:.2f} {:.2f} {:.2f} {:.4f} {:.4f} {:.4f} {:.6f} {:.6f} {:.6f} {:.6f}", frame,
      l.id, l.type, l.truncated, l.occluded, l.alpha_rad, l.left_px, l.top_px, l.right_px, l.bottom_px, l.height_m,
      l.width_m, l.length_m, l.location_cam.x(), l.location_cam.y(), l.location_cam.z(), l.rotation_y_rad);
}

std::vector<VehicleMotionSample> sensedMotion(const Scene& scene, int frames) {
  constexpr std::uint64_t kOwnStream = 0x5E45;  // of random numbers: pictures use others of the same seed
  std::mt19937_64 random(kOwnStream + scene.seed);
  std::uniform_real_distribution<double> upTo(-1, 1), share(0, 1);
  std::normal_distribution<double> noise;
  const double end_s = scene.frame_s * (frames - 1);
  const double scale = 1 + kScale * upTo(random), bias_radps = kBias_radps * upTo(random);
  const double spin_s = (0.3 + 0.6 * share(random)) * end_s;
  std::vector<VehicleMotionSample> samples;
  for (int k = 0; k * kSample_s <= end_s; ++k) {
    const double t_s = k * kSample_s;
    const Motion true_motion = motionAt(scene.ego.trajectory, t_s);
    const bool spins = t_s >= spin_s && t_s < spin_s + kSpin_s && true_motion.speed_mps > 1;
    samples.push_back(
        {.stamp = {std::llround(1e9 * (t_s + kDelay_s))},
         .speed_mps = scale * true_motion.speed_mps + (spins ? kSpin_mps : 0) + kSpeedNoise_mps * noise(random),
         .yaw_rate_radps = true_motion.yaw_rate_radps + bias_radps + kYawRateNoise_radps * noise(random)});
  }
  return samples;
}

}  // namespace motorcade::synth
