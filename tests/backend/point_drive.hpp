#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/stereo_camera.hpp"
#include "tests/backend/simulated_drive.hpp"
#include "tests/support/noise.hpp"

namespace motorcade::test {

inline const StereoCamera kPointRig{720, 720, 620, 188, 0.54, 1242, 375};

/// A simulated drive whose objects come as points with noise, in place of poses: a point is seen for some frames and
/// then replaced by another one. Only where a body's frame lies at first is told.
class PointDrive {
 public:
  struct Options {
    int points = 40;       // of each object
    int life_frames = 15;  // of a point
    double sigma_px = 0.25;
    double claimed = 1;         // standard deviation that is told, over the true one
    double field_sigma_px = 0;  // of an error that all points in one cell of the image share over the whole drive
    double shake_px = 0;        // standard deviation of an error that all disparities of a frame share
    int undecided_frames = 0;   // from an object's point being seen first to it being known as the object's
    bool tells_undecided = true;
    int static_points = 0;  // points at rest, replaced likewise
    double offset_px = 0;   // true minus measured disparity
    SimulatedDrive::Options drive;
  };
  PointDrive(std::uint64_t seed, const Options& options)
      : drive_(seed, options.drive), noise_(seed), points_(options) {}

  const SimulatedDrive::Options& options() const { return drive_.options(); }
  const SimulatedDrive& truth() const { return drive_; }

  FrameMeasurementsPtr measure(int frame) {
    FrameMeasurements m = *drive_.measure(frame);
    if (points_.shake_px > 0) shake_px_ = noise_.gaussian(points_.shake_px);
    for (ObjectObservation& seen : m.objects) {
      const auto vehicle = static_cast<std::size_t>(seen.track.value - 100);
      const int at = static_cast<int>(seen.frame.value);
      seen.T_cam_body = drive_.camera(at).inverse() * drive_.object(vehicle, at);
      seen.motion.reset();
      look(seen, vehicle, at, m.undecided);
    }
    lookAround(m, frame);
    std::ranges::sort(m.undecided, {}, &PointMeasurement::point);
    if (!points_.tells_undecided) m.undecided.clear();
    return std::make_shared<const FrameMeasurements>(std::move(m));
  }

 private:
  /// Points at rest around where the camera was when they were seen first.
  void lookAround(FrameMeasurements& m, int frame) {
    for (int k = 0; k < points_.static_points; ++k) {
      const int generation = (frame + k) / points_.life_frames;
      const std::int64_t id = 1'000'000 + static_cast<std::int64_t>(generation) * points_.static_points + k;
      Noise place(static_cast<std::uint64_t>(id));
      const SE3 T_world_then = drive_.camera(std::max(0, generation * points_.life_frames - k));
      const Eigen::Vector3d p_world = T_world_then * place.inBox({-15, -3, 20}, {15, 1.6, 70});
      if (const auto uvd = kPointRig.project(drive_.camera(frame).inverse() * p_world))
        m.at_rest.push_back(see({id}, *uvd));
    }
    std::ranges::sort(m.at_rest, {}, &PointMeasurement::point);
  }

  Eigen::Vector3d fieldAt(const Eigen::Vector3d& uvd_px) const {
    constexpr double kCell_px = 100;
    Noise of_cell(
        static_cast<std::uint64_t>(20 * std::floor(uvd_px.y() / kCell_px) + std::floor(uvd_px.x() / kCell_px)));
    const Eigen::Vector3d sigma_px = Eigen::Vector3d::Constant(points_.field_sigma_px);
    return of_cell.gaussian(sigma_px);
  }

  PointMeasurement see(PointId id, const Eigen::Vector3d& uvd_px) {
    const Eigen::Vector3d sigma_px = Eigen::Vector3d::Constant(points_.sigma_px);
    const Eigen::Vector3d seen_px =
        uvd_px + Eigen::Vector3d(0, 0, shake_px_ - points_.offset_px) + fieldAt(uvd_px) + noise_.gaussian(sigma_px);
    return {id, seen_px.cast<float>(), (points_.claimed * sigma_px).cast<float>()};
  }

  void look(ObjectObservation& seen, std::size_t vehicle, int frame, std::vector<PointMeasurement>& undecided) {
    for (int k = 0; k < points_.points; ++k) {
      const int generation = (frame + k) / points_.life_frames;
      const std::int64_t id = (static_cast<std::int64_t>(vehicle) * 1000 + generation) * points_.points + k;
      Noise shape(static_cast<std::uint64_t>(id));
      const auto uvd = kPointRig.project(seen.T_cam_body * shape.inBox({-2, -0.9, 0}, {2, 0.9, 1.5}));
      if (!uvd) continue;
      const bool known = (frame + k) % points_.life_frames >= points_.undecided_frames;
      (known ? seen.measured : undecided).push_back(see({id}, *uvd));
    }
    std::ranges::sort(seen.measured, {}, &PointMeasurement::point);
  }

  SimulatedDrive drive_;
  Noise noise_;
  Options points_;
  double shake_px_ = 0;  // of this frame
};

/// Vehicles in a street whose points at rest are seen, too, and an odometry that errs.
inline const PointDrive::Options kStreet{.static_points = 150,
                                         .drive = {.odometry_sigma_m = 0.02, .odometry_sigma_rad = 0.001}};

}  // namespace motorcade::test
