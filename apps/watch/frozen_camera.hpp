#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/watch/input_check.hpp"
#include "core/messages.hpp"

namespace motorcade {

/// Notices a camera that hangs: its image repeats to the bit while most pixels of the other camera's change. A camera
/// that sees a scene at rest still has noise, and one without light shows nothing that could repeat.
class FrozenCamera {
 public:
  static constexpr int kPairs = 12;  // in a row; fewer are lost frames, and are bridged

  struct Side {
    std::string name;   // left or right
    FrameId last_good;  // the pair whose image repeats
  };
  /// Takes the whole pairs in order. Returns the side once its image has repeated in so many pairs.
  std::optional<Side> observe(const StereoFrame& pair);

 private:
  struct Camera {
    const char* name;
    std::vector<std::uint8_t> rows{}, before{};  // some of the newest image, and of the one before
    FrameId since{};                             // first pair with the newest image
    int repeated = 0;
  };
  static bool repeats(const Image& image, Camera& camera, FrameId frame);
  static double changedShare(const Camera& camera);
  static bool hasContent(const Camera& camera);

  Camera left_{"left"}, right_{"right"};
};

/// The finding on that side.
Finding findingOf(const FrozenCamera::Side& side);

}  // namespace motorcade
