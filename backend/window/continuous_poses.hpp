#pragma once

#include <deque>
#include <functional>
#include <map>
#include <optional>

#include "core/messages.hpp"

namespace motorcade {

/// Poses of camera and objects as they are published. Each frame corrects the whole past, and a correction published as
/// it is would look like a motion. So a published pose moves by the estimated motion since, and corrections are added
/// gradually, over `correction_s`; 0 publishes each pose as it is estimated. Covariances contain what is still to be
/// added: a pose that is known to be off by d has the expected squared error Sigma + d d'.
///
/// Frames that were not measured have guessed poses. The first measured frame after them takes back the guess at once.
class ContinuousPoses {
 public:
  explicit ContinuousPoses(double correction_s) : correction_s_(correction_s) {}

  /// Present estimates of an earlier frame's poses in the world; empty when they are not known any more.
  struct EarlierPoses {
    std::function<std::optional<SE3>(FrameId)> camera;
    std::function<std::optional<SE3>(TrackId, FrameId)> object;
  };
  /// Changes the poses of the newest frame and their covariances. Objects keep their place relative to the camera. The
  /// covariance of the camera's motion begins at `motion_begin`.
  void operator()(FrameEstimate& online, const EarlierPoses& earlier, std::optional<FrameId> motion_begin);

 private:
  struct Published {
    FrameHead head;
    SE3 T_world;
  };
  SE3 continued(const Published& last, const SE3& then, const SE3& now, const SE3& target, Timestamp stamp,
                double correction_s) const;
  bool endsGuess(const FrameHead& now) const;
  void continueCamera(FrameEstimate& online, const EarlierPoses& earlier);
  void widenCamera(CameraCovariances& covariances, const SE3& estimated, const EarlierPoses& earlier,
                   std::optional<FrameId> motion_begin) const;
  const Published* cameraIn(FrameId frame) const;

  double correction_s_;
  std::deque<Published> cameras_;  // the newest ones
  std::map<TrackId, Published> last_;
};

}  // namespace motorcade
