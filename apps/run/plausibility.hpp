#pragma once

#include <optional>
#include <string>

#include "core/messages.hpp"

namespace motorcade {

/// Watches for an impossible drive. Times in another unit than seconds, or a wrong rate, make the camera faster than
/// any car, or its pairs too far apart to follow anything.
class Plausibility {
 public:
  /// Takes the online estimates in order. Returns a sentence that says what is not plausible and how to mend it, one of
  /// each kind.
  std::optional<std::string> observe(const FrameEstimate& online);

 private:
  /// Frames in a row in which a condition holds; true when it has held long enough, once.
  class Persistent {
   public:
    bool observe(bool holds);

   private:
    int frames_ = 0;
    bool told_ = false;
  };

  struct Seen {
    Timestamp stamp;
    FrameStatus status;
    SE3 T_world_cam;
  };
  std::optional<Seen> before_;
  Persistent far_apart_, close_together_, too_fast_;
};

}  // namespace motorcade
