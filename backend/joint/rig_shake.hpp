#pragma once

#include <map>
#include <span>
#include <vector>

#include "backend/joint/landmark_elimination.hpp"
#include "core/ids.hpp"

namespace motorcade {

/// Shake of the two cameras against each other: in each frame, all disparities are off by the same error. It is white
/// noise, whose standard deviation the landmarks at rest tell.
class RigShake {
 public:
  /// `sigma_px` is the assumed deviation before the shake is seen; with 0 the cameras never shake.
  explicit RigShake(double sigma_px) : first_sigma_px_(sigma_px) {}

  /// Standard deviation as it was found.
  double sigma_px() const;
  /// Corrections to add to the disparities of these frames; 0 where they are not known.
  std::vector<double> px(std::span<const FrameId> frames) const;

  /// Takes in the shakes of frames as the landmarks tell them with a prior of `sigma_px`, oldest first.
  void observe(std::span<const FrameId> frames, std::span<const FrameShake> shakes);
  /// Forgets this frame and older ones, which are not asked for any more.
  void forget(FrameId oldest) { px_.erase(px_.begin(), px_.upper_bound(oldest)); }

 private:
  void learn(const FrameShake& shake);

  double first_sigma_px_;
  std::map<FrameId, double> px_;  // to be added to the disparities
  FrameId learned_;               // the newest frame that the deviation knows
  double weighted_sum_ = 0, weight_ = 0;
};

}  // namespace motorcade
