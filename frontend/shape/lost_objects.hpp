#pragma once

#include <map>
#include <vector>

#include "core/messages.hpp"

namespace motorcade {

/// Remembers objects for some frames after they were lost, where they would be by now. A large vehicle that passes
/// close by is lost before it has gone, and what is found on it then is a part of it. Call in frame order.
class LostObjects {
 public:
  static constexpr std::int64_t kMost = 10;  // frames, after which a prediction is meters off

  /// Returns the lost objects in a frame that has others, ordered by track.
  std::vector<ObjectEstimate> predictedIn(const FrameEstimate& online) const;
  /// Call once a frame's objects are complete.
  void remember(const FrameEstimate& online);

 private:
  struct LastSeen {
    FrameId frame;
    Timestamp stamp;
    ObjectEstimate object;
  };
  std::map<TrackId, LastSeen> last_seen_;
  int segment_ = 0;
};

}  // namespace motorcade
