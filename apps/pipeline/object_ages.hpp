#pragma once

#include <map>

#include "core/messages.hpp"

namespace motorcade {

/// Fills in the time since each object was first followed. Call it in frame order, for online and final estimates
/// apart.
class ObjectAges {
 public:
  void fill(FrameEstimate& estimate);

 private:
  struct Life {
    Timestamp first, last;
  };
  std::map<TrackId, Life> lives_;
};

}  // namespace motorcade
