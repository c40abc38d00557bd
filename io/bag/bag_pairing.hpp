#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>

#include "io/bag/bag_image.hpp"
#include "io/sequence.hpp"

namespace motorcade {

struct BagPair {
  BagImage left, right;
};

/// Joins images of both sides whose stamps agree, whichever comes first. A bounded number of each side waits; the
/// oldest goes when there are more, and so does what is older than a pair.
class BagPairing {
 public:
  /// Cameras with a common trigger have the same stamps, or differ by what the driver takes; at 5 ms a car of 20 m/s
  /// has driven a decimeter.
  static constexpr std::int64_t kTolerance_ns = 5'000'000;
  static constexpr std::size_t kMostWaiting = 32;  // of each side
  static constexpr std::size_t kMostWaiting_bytes = std::size_t{128} << 20;

  /// The pair that the image completes.
  std::optional<BagPair> add(StereoSide side, BagImage image);

  /// Images that came and can no longer have a partner, at the end those included that still wait.
  std::size_t unpaired(StereoSide side) const { return sides_[place(side)].dropped; }
  void dropWaiting();
  /// The least difference of two stamps that were no pair; empty where there are none.
  std::optional<std::int64_t> nearest_ns() const { return nearest_ns_; }

 private:
  struct Side {
    std::deque<BagImage> waiting{};
    std::size_t bytes = 0;
    std::size_t dropped = 0;

    void drop(std::deque<BagImage>::iterator image);
    void dropOlderThan(std::int64_t stamp_ns);
  };
  static std::size_t place(StereoSide side) { return side == StereoSide::kLeft ? 0 : 1; }
  std::deque<BagImage>::iterator partnerOf(const BagImage& image, Side& others);

  Side sides_[2];
  std::optional<std::int64_t> nearest_ns_{};
};

}  // namespace motorcade
