#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/messages.hpp"

namespace motorcade::perf {

/// Fingerprints of all that a run publishes about the camera and the objects, bit by bit, one per frame: equal for
/// equal results, in a few bytes per frame.
struct ResultDigests {
  std::vector<std::uint64_t> online, final;

  bool operator==(const ResultDigests&) const = default;
};

std::uint64_t digestOf(const FrameEstimate& estimate);

/// The first frame whose results differ, online or final, or that only one of them has; empty when there is none.
std::optional<std::size_t> firstDifference(const ResultDigests& a, const ResultDigests& b);

}  // namespace motorcade::perf
