#pragma once

#include <vector>

#include "apps/evaluate/comparison/object_matching.hpp"
#include "apps/evaluate/comparison/trajectory_error.hpp"

namespace motorcade {

/// Errors of one quantity, and the share of them within 1.96 of the estimated standard deviations.
struct CoveredErrors {
  Statistics errors;
  double coverage = 0;
};

/// Errors of the objects' accelerations where the truth is exact. Labels that jitter cannot judge them.
struct AccelerationErrors {
  int rows = 0;  // that are asked, also those that tell none
  CoveredErrors along_mps2, yaw_radps2;
};

/// Errors over reported rows on labels that are asked for, from the tenth row of each track on. The true acceleration
/// is the change of a label's speed and yaw rate from 0.2 s before to 0.2 s after a frame. Speed and yaw rate are
/// central differences over the neighboring frames. Rows count where all of these frames have the label. `stamps` are
/// the times of the sequence's frames.
AccelerationErrors accelerationErrors(const std::vector<ComparedFrame>& frames, const std::vector<Timestamp>& stamps);

}  // namespace motorcade
