#pragma once

#include <optional>

#include "backend/solver/incremental_solver.hpp"

namespace motorcade {

/// Disparity offset of the rig, a variable of the graph that is added to all disparities.
///
/// A rig is taken as calibrated until the landmarks of its first frames clearly contradict it; only then does its
/// offset move. Lens distortions alone look like an offset of 0.2 to 0.4 px on real rigs, depending on where in the
/// image the points are. Correcting that makes paths worse.
class RigOffset {
 public:
  /// `sigma_px` is the deviation of the offset's prior once it may move; with 0 it never may.
  RigOffset(IncrementalSolver& solver, double sigma_px);

  VariableId variable() const { return variable_; }
  double px() const;
  double sigma_px() const;

  /// Compares the offset with what the landmarks say, after each frame, and lets it move where they are clear. Returns
  /// true when that has just happened: the solver has a new prior.
  bool release(FrameId newest);
  /// True when the offset is so far from where landmarks were eliminated that they should be eliminated anew.
  bool hasMoved() const;
  /// Notes that landmarks are eliminated at the present offset.
  void holdAsEliminated() { eliminated_px_ = px(); }
  /// True when the drive is so old that the offset stays where it is.
  bool isDecided(FrameId newest) const;

 private:
  void setPrior(double sigma_px);
  std::optional<double> observed_px() const;

  IncrementalSolver& solver_;
  double released_sigma_px_;
  VariableId variable_;
  std::optional<FactorId> prior_;
  bool released_ = false;
  double eliminated_px_ = 0;  // at which landmarks were
  FrameId first_frame_;
};

}  // namespace motorcade
