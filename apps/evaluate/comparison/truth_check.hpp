#pragma once

#include <optional>
#include <vector>

#include "core/messages.hpp"
#include "core/se3.hpp"
#include "io/truth/ground_truth.hpp"

namespace motorcade {

/// The covariance that a real drive's truth adds to errors of the camera's motion over `kCameraCovarianceFrames`.
///
/// The gyroscopes of KITTI's inertial unit err by .01 deg. White noise of the truth's poses shows in the motions from
/// one frame to the next. Successive errors cancel: their covariance is minus the variance of one pose. A motion has
/// twice that variance. An estimate that errs in the same way is forgiven for it.
Matrix6d truthNoise(const std::vector<SE3>& estimate, const std::vector<SE3>& truth);

/// The mean squared difference of the camera's motion over as many frames between two truths, along its axes [m^2]: one
/// by measured positions, one by measured velocities.
Eigen::Matrix3d placeNoise(const std::vector<SE3>& by_position, const std::vector<SE3>& by_velocity);

/// Compares the truth's path with the velocities of the inertial unit, over the frames that have a true pose.
struct TruthCheck {
  double way_m = 0, velocity_way_m = 0;  // in chords of 5 m and more, so that jitter adds nothing
  double largest_step_m = 0;             // between the two motions over a chord
  FrameId step_from, step_to;            // where
  double differencePercent() const;      // of the way, positive where the velocities go farther
  bool waysDiffer() const;
  bool jumps() const;
  /// True when positions and velocities cannot both be right: the ways differ by more than 1 % and 1 m, or one chord's
  /// motions by more than 1 m. The unit's velocities are good to some .05 m/s, .5 % of the way at the speed of a car,
  /// its positions to some .5 m. A truth that is wrong by 1 % cannot judge cameras whose errors are about 1 %.
  bool doubtful() const { return waysDiffer() || jumps(); }
};

/// Empty where the sequence has no velocities, no calibration of the unit, or no times of the packets.
std::optional<TruthCheck> checkTruth(const Sequence& sequence, const CameraTruth& truth);

/// Angle between the main directions of two paths, each as its own camera sees it [deg]; 0 where one of them has none.
/// Mountings of inertial units are off by a degree or two. An angle above `kOtherFrame_deg` means that the truth has
/// poses of another frame than the camera's (x ahead, as of inertial units), or quaternions in another order.
double courseDifference_deg(const std::vector<SE3>& estimate, const std::vector<SE3>& truth);
inline constexpr double kOtherFrame_deg = 20;

}  // namespace motorcade
