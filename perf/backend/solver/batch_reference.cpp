#include "perf/backend/solver/batch_reference.hpp"

#include <algorithm>
#include <cmath>

namespace motorcade::perf {
namespace {

constexpr int kMaxIterations = 40;
constexpr double kConverged = 1e-6;  // m and rad
constexpr double kExact = 1e-6;      // chi2 of measurements that agree: an open chain's optimum is 0

}  // namespace

bool BatchReference::advanceTo(std::size_t updates) {
  for (; updates_ < updates; ++updates_) feed_.next();
  return converge(feed_.solver());
}

bool converge(IncrementalSolver& solver) {
  const auto& report = solver.converge(kMaxIterations, kConverged);
  return report.largest_change < kConverged && std::isfinite(solver.counters().chi2);
}

double excessPercent(double chi2, double optimum) { return 100 * (chi2 - optimum) / std::max(optimum, kExact); }

}  // namespace motorcade::perf
