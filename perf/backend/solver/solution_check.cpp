#include "perf/backend/solver/solution_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <set>

#include <Eigen/Cholesky>

#include "perf/backend/solver/batch_reference.hpp"
#include "tests/backend/perturbation.hpp"

namespace motorcade::perf {
namespace {

constexpr std::size_t kTenths = 10, kRandomUpdates = 100;
constexpr double kUnknown = std::numeric_limits<double>::infinity();

std::set<std::size_t> tenths(std::size_t updates) {
  std::set<std::size_t> ends;
  for (std::size_t i = 1; i <= kTenths; ++i) ends.insert(std::max<std::size_t>(1, updates * i / kTenths));
  return ends;
}

std::set<std::size_t> randomUpdates(std::size_t updates, std::uint64_t seed) {
  std::vector<std::size_t> all(updates), chosen;
  std::iota(all.begin(), all.end(), std::size_t{1});
  std::ranges::sample(all, std::back_inserter(chosen), static_cast<std::ptrdiff_t>(kRandomUpdates),
                      std::mt19937_64(seed));
  return {chosen.begin(), chosen.end()};
}

double sigmasOff(const IncrementalSolver& batch, const IncrementalSolver& measured, VariableId v) {
  const auto covariance = batch.jointCovariance(std::span(&v, 1));
  if (!covariance) return kUnknown;
  const Eigen::LLT<Eigen::MatrixXd> root(*covariance);
  if (root.info() != Eigen::Success) return kUnknown;
  const SmallVector difference = test::local(batch.estimate(v), measured.estimate(v));
  return root.matrixL().solve(difference).norm() / std::sqrt(static_cast<double>(difference.size()));
}

/// Both feeds number their variables in the order in which they came.
double newestPosesOff(const PoseGraphFeed& batch, const PoseGraphFeed& measured, int newest) {
  double worst = 0;
  const auto count = static_cast<std::int64_t>(measured.poseCount());
  for (std::int64_t v = count - newest; v < count; ++v)
    worst = std::max(worst, sigmasOff(batch.solver(), measured.solver(), {v}));
  return worst;
}

void findFailures(SolutionCheck& check) {
  for (const auto& [updates, excess] : check.chi2)
    if (!(excess <= SolutionCheck::kMaxExcessPercent))
      check.failures.push_back("after " + std::to_string(updates) + " updates: chi2 " + std::to_string(excess) +
                               " % above the batch optimum");
  for (const auto& [updates, sigmas] : check.pose)
    if (!(sigmas <= SolutionCheck::kMaxPoseSigmas))
      check.failures.push_back("after " + std::to_string(updates) + " updates: newest pose " + std::to_string(sigmas) +
                               " sigmas from the batch solution");
}

}  // namespace

SolutionCheck checkAgainstBatch(const PoseGraph& graph, const IncrementalSolver::Params& params, std::uint64_t seed) {
  SolutionCheck check;
  PoseGraphFeed feed(graph, params);
  BatchReference batch(graph);
  const auto for_chi2 = tenths(feed.updateCount()), for_pose = randomUpdates(feed.updateCount(), seed);
  for (std::size_t updates = 1; !feed.atEnd(); ++updates) {
    const auto update = feed.next();
    const bool compare_chi2 = for_chi2.contains(updates), compare_pose = for_pose.contains(updates);
    if (!compare_chi2 && !compare_pose) continue;
    if (!batch.advanceTo(updates))
      check.failures.push_back("after " + std::to_string(updates) + " updates: the batch solution does not converge");
    if (compare_chi2) check.chi2.push_back({updates, excessPercent(feed.chi2(), batch.feed().chi2())});
    if (compare_pose) check.pose.push_back({updates, newestPosesOff(batch.feed(), feed, update.poses)});
  }
  findFailures(check);
  return check;
}

}  // namespace motorcade::perf
