#include "perf/backend/solver/multibody_run.hpp"

#include <algorithm>
#include <span>

#include "core/thread_placement.hpp"
#include "perf/backend/solver/batch_reference.hpp"
#include "perf/backend/solver/multibody_stream.hpp"
#include "perf/support/process_memory.hpp"

namespace motorcade::perf {
namespace {

constexpr int kFirstBin = 1000, kHalfBin = 500;
constexpr int kAgingFrames = 1000;
constexpr int kErrorFrames = 10;  // apart, so that errors are independent

/// Frames 1000, 2000, 5000, 10000, ..., as far as their bins do not meet that of the last frame.
std::vector<int> binFrames(int frames) {
  std::vector<int> middles;
  for (int decade = kFirstBin; decade < frames; decade *= 10)
    for (const int step : {1, 2, 5})
      if (step * decade + 2 * kHalfBin <= frames) middles.push_back(step * decade);
  middles.push_back(frames);
  return middles;
}

/// A solver that is driven, and what each update cost.
class Drive {
 public:
  /// Reserves memory for the costs of so many frames at the start, so that the process does not grow by it.
  Drive(const IncrementalSolver::Params& params, int window_frames, int frames)
      : solver_(params), stream_(solver_, window_frames) {
    for (auto* costs : {&update_ms_, &retire_ms_, &eliminated_scalars_, &substituted_scalars_}) {
      costs->assign(frames, 0);
      costs->clear();
    }
  }

  /// Runs one update: new variables and factors, the step, retirement.
  void update(const SimulatedFrame& frame) {
    const double start_ms = threadCpu_ms();
    stream_.add(frame);
    const auto& report = solver_.update();
    eliminated_scalars_.push_back(static_cast<double>(report.eliminated_scalars));
    substituted_scalars_.push_back(static_cast<double>(report.substituted_scalars));
    problems_ += report.problems.size();
    const double updated_ms = threadCpu_ms();
    if (const auto retired = stream_.takeRetired(); !retired.empty()) solver_.retire(retired);
    const double end_ms = threadCpu_ms();
    update_ms_.push_back(end_ms - start_ms);
    retire_ms_.push_back(end_ms - updated_ms);
  }

  IncrementalSolver& solver() { return solver_; }
  const IncrementalSolver& solver() const { return solver_; }
  const MultibodyStream& stream() const { return stream_; }
  std::size_t problems() const { return problems_; }
  // Quantiles of the updates from one on.
  Quantiles updateTimes_ms(std::size_t from) const { return quantilesOf(std::span(update_ms_).subspan(from)); }
  Quantiles retireTimes_ms(std::size_t from) const { return quantilesOf(std::span(retire_ms_).subspan(from)); }
  Quantiles eliminatedScalars(std::size_t from) const {
    return quantilesOf(std::span(eliminated_scalars_).subspan(from));
  }
  Quantiles substitutedScalars(std::size_t from) const {
    return quantilesOf(std::span(substituted_scalars_).subspan(from));
  }

 private:
  IncrementalSolver solver_;
  MultibodyStream stream_;
  std::vector<double> update_ms_, retire_ms_, eliminated_scalars_, substituted_scalars_;
  std::size_t problems_ = 0;
};

/// `errors` are those since the bin began.
MultibodyBin binAround(int middle, const Drive& drive, const std::vector<double>& errors) {
  const auto begin = static_cast<std::size_t>(std::max(0, middle - kHalfBin));
  const double error_count = static_cast<double>(std::max<std::size_t>(1, errors.size()));
  return {.frame = middle,
          .update_ms = drive.updateTimes_ms(begin),
          .retire_ms = drive.retireTimes_ms(begin),
          .eliminated_scalars = drive.eliminatedScalars(begin),
          .substituted_scalars = drive.substitutedScalars(begin),
          .normalized_error = quantilesOf(errors).total / error_count,
          .held_bytes = drive.solver().heldBytes(),
          .heap_bytes = heapBytes(),
          .resident_bytes = residentBytes(),
          .variables = drive.solver().graph().variableCount(),
          .factors = drive.solver().graph().factorCount()};
}

std::vector<MultibodyBin> driveThroughBins(Drive& drive, MultibodyScene& scene, int frames) {
  std::vector<MultibodyBin> bins;
  std::vector<double> errors;
  const auto middles = binFrames(frames);
  for (int frame = 0; frame < frames; ++frame) {
    drive.update(scene.next());
    const int middle = middles[bins.size()];
    if (frame < middle - kHalfBin) continue;
    if (frame % kErrorFrames == 0)
      if (const auto error = drive.stream().normalizedError(kErrorFrames)) errors.push_back(*error);
    if (frame + 1 < std::min(middle + kHalfBin, frames)) continue;
    bins.push_back(binAround(middle, drive, errors));
    errors.clear();
  }
  return bins;
}

MultibodyAging measureAging(Drive& old, MultibodyScene& scene, const IncrementalSolver::Params& params,
                            const MultibodyOptions& options) {
  const int warm_up = options.window_frames + MultibodyScene::kMaxLifeFrames;
  Drive young(params, options.window_frames, warm_up + kAgingFrames);
  for (int i = 0; i < warm_up + kAgingFrames; ++i) {
    const SimulatedFrame frame = scene.next();
    old.update(frame);
    young.update(frame);
  }
  const auto compared = static_cast<std::size_t>(warm_up);
  const std::size_t compared_old = compared + options.frames;
  return {.old_ms = old.updateTimes_ms(compared_old).median,
          .young_ms = young.updateTimes_ms(compared).median,
          .old_scalars = old.eliminatedScalars(compared_old).median,
          .young_scalars = young.eliminatedScalars(compared).median};
}

/// Cost of all factors at the estimates. The solver's own count holds each factor as it was when the solver last looked
/// at it.
double costOf(const IncrementalSolver& solver) {
  const FactorGraph& graph = solver.graph();
  double cost = 0;
  for (const FactorId id : graph.factors()) {
    const Factor& factor = graph.models().factor(id);
    std::vector<Value> values;
    std::vector<const Value*> pointers;
    for (const VariableId v : factor.variables()) values.push_back(solver.estimate(v));
    for (const Value& value : values) pointers.push_back(&value);
    int columns = 1;
    for (const Value& value : values) columns += dimension(value);
    Eigen::MatrixXd fresh(factor.rows(), columns);
    factor.linearize(pointers, fresh);
    const auto last = fresh.col(fresh.cols() - 1);
    cost += graph.models().isJacobian(id) ? last.squaredNorm() : last[last.size() - 1];
  }
  return cost;
}

/// Excess over the converged solution. The cost itself contains that of all that was retired, in which it would vanish.
double excessOverConverged(IncrementalSolver& solver) {
  const double cost = costOf(solver);
  converge(solver);
  constexpr double kRows = 6;
  return 100 * (cost - costOf(solver)) / (kRows * static_cast<double>(solver.graph().factorCount()));
}

}  // namespace

std::optional<double> MultibodyRun::timeGrowth() const {
  if (bins.size() < 2 || bins.front().frame != kFirstBin) return std::nullopt;
  return bins.back().update_ms.median / bins.front().update_ms.median;
}

MultibodyRun runMultibody(const IncrementalSolver::Params& params, const MultibodyOptions& options) {
  MultibodyRun run;
  run.options = options;
  MultibodyScene scene(options.objects, options.seed);
  Drive drive(params, options.window_frames, options.frames);
  run.bins = driveThroughBins(drive, scene, options.frames);
  run.update_ms = drive.updateTimes_ms(0);
  if (options.window_frames > 0) run.aging = measureAging(drive, scene, params, options);
  run.problems = drive.problems();
  run.chi2_excess_percent = excessOverConverged(drive.solver());
  return run;
}

}  // namespace motorcade::perf
