#pragma once

#include <deque>
#include <map>
#include <string>

#include "core/messages.hpp"

namespace motorcade {

/// Makes a foxglove.SceneUpdate of each frame's objects: an entity `object_N` in the world with its cuboid, the path of
/// its center over the last three seconds, and a label. Objects that have left are deleted. Call it in frame order.
class SceneMessages {
 public:
  std::string operator()(const FrameEstimate& estimate);

 private:
  struct Passed {
    Timestamp stamp;
    Eigen::Vector3d p_world;
  };
  void remember(const FrameEstimate& estimate);

  std::map<TrackId, std::deque<Passed>> ways_;  // of the objects in the frame before
};

}  // namespace motorcade
