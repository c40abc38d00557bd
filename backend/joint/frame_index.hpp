#pragma once

#include <functional>
#include <span>
#include <vector>

#include "backend/joint/body_points.hpp"
#include "backend/joint/noise_level.hpp"

namespace motorcade {

/// The variable that the body's pose in a frame is; invalid where the graph does not hold it.
using PoseVariable = std::function<VariableId(FrameId)>;

/// The frames in which landmarks were seen, which are few and near each other, as far as the graph holds their poses:
/// the frames and variables of a factor.
class FrameIndex {
 public:
  /// There is at least one track.
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
