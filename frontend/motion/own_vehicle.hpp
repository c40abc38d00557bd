#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/messages.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/matching/circular_matching.hpp"
#include "frontend/messages.hpp"
#include "frontend/motion/camera_trail.hpp"
#include "frontend/motion/own_vehicle_map.hpp"

namespace motorcade {

/// Finds what is fixed to the camera, as the own vehicle's hood: near points that stay in place in both images while
/// a point at rest would have moved far. Each is left out as soon as it shows. Where such points were seen often, the
/// image is masked from there to its border, as reflections move on a hood. Call `learn` in frame order.
class OwnVehicle {
 public:
  explicit OwnVehicle(const StereoCamera& camera);

  /// Takes out the observations of the own vehicle.
  void leaveOut(const OpticalFlow& flow, std::vector<std::optional<StereoObservation>>& observed) const;

  /// Learns from a frame in which the camera's motion was measured, the newest of the trail. `seen` has one item per
  /// flow observation, those of the own vehicle among them.
  void learn(const OpticalFlow& flow, const std::vector<std::optional<StereoObservation>>& seen,
             const CameraTrail& trail);
  /// Forgets the points seen so far: the motion up to the next frame is not known, so they cannot be compared.
  void forgetPoints() { watched_.clear(); }
  /// Adds to the disparities of all points that were seen.
  void shiftDisparities(double change_px);

  /// Masked part of the image; empty while nothing is.
  const std::optional<OwnVehicleView>& view() const { return map_.view(); }

 private:
  /// A point that may be fixed to the camera, or lies where such points are.
  struct Watched {
    PointId point;
    std::int64_t step;  // of the observation that it is compared with
    Eigen::Vector3d uvd_px, sigma_px;
    bool fixed = false;  // it stayed while a point at rest would have moved
  };
  enum class Verdict { kNone, kStays, kRests };
  /// A near point that stays.
  struct Staying {
    std::size_t watched;  // its index
    Eigen::Vector3d p_cam;
  };

  bool isNear(const StereoObservation& seen) const;
  bool isOfInterest(const StereoObservation& seen) const;
  bool stays(const Watched& point, const StereoObservation& seen) const;
  Verdict judge(Watched& point, const StereoObservation& seen, const CameraTrail& trail) const;
  void takeFixed(std::vector<Staying> staying, std::vector<Watched>& watched);
  void widen(const std::vector<Staying>& staying);
  bool isTimeToVote(const CameraTrail& trail);

  StereoCamera camera_;
  OwnVehicleMap map_;
  double left_m_, right_m_;                  // how far aside the own vehicle reaches, as far as it is known
  std::vector<Watched> watched_;             // ordered by point
  std::optional<Eigen::Vector3d> voted_at_;  // where the camera was then, in the trail's world
};

}  // namespace motorcade
