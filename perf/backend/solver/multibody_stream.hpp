#pragma once

#include <deque>
#include <vector>

#include "backend/factors/pose_factors.hpp"
#include "backend/solver/incremental_solver.hpp"
#include "perf/backend/solver/multibody_scene.hpp"

namespace motorcade::perf {

/// Feeds a solver with simulated frames, as the smoother of `motorcade run` does with measured ones. Variables, factors
/// and losses are the same. Poses beyond a window of frames are marginalized; an object's anchor goes with its last
/// pose.
class MultibodyStream {
 public:
  /// A window of 0 keeps everything.
  MultibodyStream(IncrementalSolver& solver, std::size_t window_frames)
      : solver_(solver), window_frames_(window_frames) {}

  /// Adds a frame's variables and factors; then update the solver. The first frame may be any of a scene: what is in
  /// view then is new.
  void add(const SimulatedFrame& frame);
  /// Returns, and forgets, the variables that are to be marginalized now.
  std::vector<VariableId> takeRetired();

  /// Squared error of the newest camera pose relative to one earlier, over its covariance and dimension: 1 on average.
  /// Empty where the window does not reach back so far.
  std::optional<double> normalizedError(std::size_t frames_back) const;

 private:
  struct Record {
    VariableId x;
    SE3 T_world_cam;                   // true
    std::vector<VariableId> of_frame;  // that leave with it
  };
  struct Object {
    VariableId anchor, z_before_last, z_last;
  };

  void addCamera(const SimulatedFrame& frame);
  void addObject(Object& object, const SimulatedFrame::Object& seen);
  void startObject(Object& object, const SimulatedFrame::Object& seen);
  void addPrior(VariableId v, const SE3& mean, const MotionSigma& sigma);

  IncrementalSolver& solver_;
  std::size_t window_frames_;
  std::deque<Record> records_;
  std::vector<Object> objects_;
};

}  // namespace motorcade::perf
