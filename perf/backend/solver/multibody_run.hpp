#pragma once

#include <optional>
#include <vector>

#include "backend/solver/incremental_solver.hpp"
#include "perf/backend/solver/quantiles.hpp"

namespace motorcade::perf {

struct MultibodyOptions {
  int objects = 5, frames = 10000, window_frames = 200;
  std::uint64_t seed = 1;
};

/// Performance of the solver around one length of a run.
struct MultibodyBin {
  int frame = 0;                                      // in the middle
  Quantiles update_ms, retire_ms;                     // CPU time; retiring is part of the update
  Quantiles eliminated_scalars, substituted_scalars;  // without those of retiring
  double normalized_error = 0;  // mean of the newest camera pose's, relative to ten frames earlier; 1 is expected
  // At its end.
  std::size_t held_bytes = 0, heap_bytes = 0, resident_bytes = 0, variables = 0, factors = 0;
};

/// Aging of a long drive's solver: it runs in turns with one that begins late in the drive, on the same frames. What
/// they hold differs only in what was retired long ago, and the machine's other load slows both.
struct MultibodyAging {
  static constexpr double kMaxRatio = 1.1;

  double old_ms = 0, young_ms = 0;  // medians of the updates' CPU times, once the young one's window is full
  double old_scalars = 0, young_scalars = 0;
  double timeRatio() const { return old_ms / young_ms; }
};

/// A simulated drive, an update per frame, with what leaves the window retired in the same update.
struct MultibodyRun {
  MultibodyOptions options;
  std::vector<MultibodyBin> bins;       // around 1000, 2000, 5000, 10000, ...
  std::optional<MultibodyAging> aging;  // after the last of the frames; empty where everything is kept
  Quantiles update_ms;                  // of all
  std::size_t problems = 0;             // that updates reported
  /// Excess of chi2 at the end over what Gauss-Newton reaches from there, in units of one per row of the factors in the
  /// window.
  double chi2_excess_percent = 0;

  /// Median time of an update in the last bin over that around frame 1000, as the machine's load allows; empty for
  /// shorter runs.
  std::optional<double> timeGrowth() const;
};
MultibodyRun runMultibody(const IncrementalSolver::Params& params, const MultibodyOptions& options);

}  // namespace motorcade::perf
