#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

#include "io/sequence/sequence.hpp"

namespace motorcade {

inline constexpr std::array kStereoSides{StereoSide::kLeft, StereoSide::kRight};
inline constexpr std::size_t indexOf(StereoSide side) { return static_cast<std::size_t>(side); }
inline constexpr StereoSide otherThan(StereoSide side) {
  return side == StereoSide::kLeft ? StereoSide::kRight : StereoSide::kLeft;
}

/// Pairs two cameras' messages by their capture stamps, in the order of arrival. Each side may miss messages or send
/// more than the other, and its clock may be set back: a pair drops all messages that came before it. `Message` has a
/// member stamp_ns.
template <class Message>
class StampPairing {
 public:
  struct Params {
    std::int64_t tolerance_ns = 5'000'000;  // between the stamps of a pair
    std::size_t most_waiting = 16;          // on each side; beyond, the oldest is dropped
  };
  struct Pair {
    Message left{}, right{};
  };
  explicit StampPairing(const Params& params) : params_(params) {}

  /// The pair that the message completes, with the nearest stamp of those that wait on the other side.
  std::optional<Pair> add(StereoSide side, Message message) {
    auto& others = waiting_[indexOf(otherThan(side))];
    const auto distance_ns = [&](const Message& other) { return apart_ns(other.stamp_ns, message.stamp_ns); };
    const auto nearest = std::ranges::min_element(others, {}, distance_ns);
    if (nearest == others.end() || distance_ns(*nearest) > static_cast<std::uint64_t>(params_.tolerance_ns)) {
      keep(side, std::move(message));
      return std::nullopt;
    }
    Message other = std::move(*nearest);
    drop(otherThan(side), static_cast<std::size_t>(nearest - others.begin()));
    others.pop_front();
    drop(side, waiting(side));
    if (side == StereoSide::kLeft) return Pair{.left = std::move(message), .right = std::move(other)};
    return Pair{.left = std::move(other), .right = std::move(message)};
  }

  std::size_t waiting(StereoSide side) const { return waiting_[indexOf(side)].size(); }
  /// Messages that were dropped without one of the other side.
  std::int64_t unpaired(StereoSide side) const { return unpaired_[indexOf(side)]; }

 private:
  /// The difference is unsigned, as stamps of a wrong unit may be further apart than an integer holds.
  static std::uint64_t apart_ns(std::int64_t a, std::int64_t b) {
    return static_cast<std::uint64_t>(std::max(a, b)) - static_cast<std::uint64_t>(std::min(a, b));
  }
  void keep(StereoSide side, Message message) {
    waiting_[indexOf(side)].push_back(std::move(message));
    if (waiting(side) > params_.most_waiting) drop(side, 1);
  }
  void drop(StereoSide side, std::size_t count) {
    auto& messages = waiting_[indexOf(side)];
    messages.erase(messages.begin(), messages.begin() + static_cast<std::ptrdiff_t>(count));
    unpaired_[indexOf(side)] += static_cast<std::int64_t>(count);
  }

  Params params_;
  std::array<std::deque<Message>, 2> waiting_{};
  std::array<std::int64_t, 2> unpaired_{};
};

}  // namespace motorcade
