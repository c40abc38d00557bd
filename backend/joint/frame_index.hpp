#pragma once

#include <functional>
#include <span>
#include <vector>

#include "backend/joint/body_points.hpp"
#include "backend/joint/noise_level.hpp"

namespace motorcade {

/// Returns the variable of the body's pose in a frame; invalid where the graph does not hold it.
using PoseVariable = std::function<VariableId(FrameId)>;

/// Frames in which landmarks were seen and whose poses the graph holds: the frames and variables of a factor. They are
/// few and near each other.
class FrameIndex {
 public:
  /// Indexes the frames of the tracks, of which there is at least one.
  FrameIndex(std::span<LandmarkTrack* const> tracks, const PoseVariable& pose_variable);

  const std::vector<FrameId>& frames() const { return frames_; }
  const std::vector<VariableId>& variables() const { return variables_; }
  /// Appends the views that are in the graph, with the noise at this level.
  void append(std::span<const LandmarkTrack::View> views, const NoiseLevel& noise, std::vector<LandmarkView>& to) const;

 private:
  static constexpr int kNone = -1, kSeen = 0;

  FrameId first_;
  std::vector<FrameId> frames_;
  std::vector<VariableId> variables_;
  std::vector<int> place_;  // of each frame from the first on among `frames_`, or kNone
};

}  // namespace motorcade
