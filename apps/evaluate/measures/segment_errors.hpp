#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "core/se3.hpp"

namespace motorcade {

/// Mean errors of the motion over a path's segments of certain lengths.
struct SegmentMeans {
  std::size_t segments = 0;
  double translation_percent = 0, rotation_deg_per_m = 0;
};

/// Errors of a path as in the KITTI odometry benchmark (Geiger et al., Are we ready for Autonomous Driving? The KITTI
/// Vision Benchmark Suite, 2012, section 3). Segments of eight lengths begin in every tenth frame. Each ends in the
/// first frame that is farther along the true path than its length. The error of its motion is divided by that length.
struct SegmentErrors {
  static constexpr std::size_t kLengths = 8;
  struct OfLength : SegmentMeans {
    double length_m = 0;
  };
  bool short_segments = false;  // of 10 to 80 m instead of 100 to 800 m: the path is shorter than 300 m
  SegmentMeans all;             // over all segments, each counting once
  std::array<OfLength, kLengths> by_length;
};

/// Empty where the path is too short for a single segment. Both paths have one pose per frame, in the same order.
std::optional<SegmentErrors> segmentErrors(const std::vector<SE3>& estimate, const std::vector<SE3>& truth);

}  // namespace motorcade
