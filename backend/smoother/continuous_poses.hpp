#pragma once

#include <functional>
#include <map>
#include <optional>

#include "core/messages.hpp"

namespace motorcade {

/// Poses of objects as they are published. Each observation corrects the whole track; published as it is, a correction
/// would look like a motion of the object. So the published pose moves by the object's estimated motion since, and
/// corrections are added gradually, over `correction_s`; 0 publishes each pose as it is estimated.
class ContinuousPoses {
 public:
  explicit ContinuousPoses(double correction_s) : correction_s_(correction_s) {}

  /// T_world_body of an earlier frame as it is estimated now; empty when it is not known any more.
  using EarlierPose = std::function<std::optional<SE3>(TrackId, FrameId)>;
  /// Changes the objects' poses of the newest frame.
  void operator()(FrameEstimate& online, const EarlierPose& earlier);

 private:
  struct Published {
    FrameId frame;
    Timestamp stamp;
    SE3 T_world_body;
  };
  double correction_s_;
  std::map<TrackId, Published> last_;
};

}  // namespace motorcade
