#include <algorithm>
#include <set>

#include <gtest/gtest.h>

#include "backend/factors/pose_factors.hpp"
#include "backend/solver/incremental_solver.hpp"
#include "tests/backend/dense_system.hpp"
#include "tests/backend/random_graphs.hpp"

/// Tests how the solver spreads its work over updates: by a budget, or on a schedule.
namespace motorcade {
namespace {

using test::DenseSystem;
using test::differenceFromBatch;
using test::kExact;
using test::MultibodyGraph;

/// Scalars of the cliques from where the factors enter up to the root, and of the variables that are not in the tree
/// yet.
std::int64_t scalarsThatNewFactorsAskFor(const IncrementalSolver& solver, const std::vector<FactorId>& before) {
  std::set<int> cliques;
  std::set<VariableId> fresh;
  for (const FactorId f : solver.graph().factors()) {
    if (std::ranges::binary_search(before, f)) continue;
    for (const VariableId v : solver.graph().variablesOf(f)) {
      if (solver.tree().cliqueOf(v) < 0) fresh.insert(v);
      for (int c = solver.tree().cliqueOf(v); c >= 0; c = solver.tree()[c].parent) cliques.insert(c);
    }
  }
  std::int64_t scalars = 0;
  for (const int c : cliques) scalars += solver.tree()[c].frontal_size;
  for (const VariableId v : fresh) scalars += solver.graph().sizeOf(v);
  return scalars;
}

IncrementalSolver::Params withBudget(std::int64_t scalars) {
  IncrementalSolver::Params params = kExact;
  // Not zero: rounding would keep something stale for ever.
  params.relinearization.mismatch_tolerance = 1e-10;
  params.relinearization.jacobian_drift_sigmas = 1e-7;
  params.relinearization.relinearize_rad = 1e-6;
  params.relinearization.leisurely_rad = 2e-7;
  params.budget.scalars = scalars;
  return params;
}

constexpr double kBudgetTol = 1e-6;  // m and rad: what turns by 1e-6 rad is not relinearized

/// Bound of the saved budget: less than a variable costs, which is less than all of them.
std::int64_t mostSaved(const IncrementalSolver& solver) {
  std::int64_t scalars = 0;
  for (const VariableId v : solver.graph().variables()) scalars += solver.graph().sizeOf(v);
  return scalars;
}

/// Runs quiet updates until nothing is put off and nothing moves; returns the number of variables still put off.
int finishOverQuietUpdates(IncrementalSolver& solver, std::int64_t budget) {
  std::int64_t eliminated = 0;
  for (int i = 0; i < 400; ++i) {
    const auto& report = solver.update();
    eliminated += report.eliminated_scalars;
    EXPECT_LE(eliminated, mostSaved(solver) + budget * (i + 1));
    if (report.deferred_variables == 0 && report.largest_change < 1e-11) return 0;
  }
  return solver.update().deferred_variables;
}

TEST(IncrementalSolverBudget, EliminatesNoMoreThanTheNewFactorsAskForAndTheBudget) {
  for (const std::int64_t budget : {1, 60, 300, 1000}) {
    for (std::uint64_t seed = 0; seed < 4; ++seed) {
      IncrementalSolver solver(withBudget(budget));
      MultibodyGraph graph(solver, seed, 2);
      std::int64_t eliminated_beyond = 0;
      for (int i = 0; i < 40; ++i) {
        const auto before = solver.graph().factors();
        graph.addFrame();
        const auto asked = scalarsThatNewFactorsAskFor(solver, before);
        const auto& report = solver.update();
        eliminated_beyond += report.eliminated_scalars - asked;
        EXPECT_LE(report.eliminated_scalars, asked + budget + mostSaved(solver));
        EXPECT_LE(eliminated_beyond, budget * (i + 1)) << "budget " << budget << ", seed " << seed << ", frame " << i;
        EXPECT_GE(report.eliminated_scalars, 6);
      }
    }
  }
}

TEST(IncrementalSolverBudget, PutsOffMarginalPriorsToo) {
  for (const std::int64_t budget : {1, 60, 1000, 100000}) {
    IncrementalSolver solver(withBudget(budget));
    MultibodyGraph graph(solver, 1, 2);
    for (int i = 0; i < 40; ++i) {
      graph.addFrame();
      solver.update();
      if (i >= 10) solver.retire(graph.takeOldest());
    }
    solver.converge(50, 1e-11);
    EXPECT_LT(differenceFromBatch(solver), 1e-8) << "budget " << budget;
  }
}

TEST(IncrementalSolverBudget, WorkThatIsPutOffIsDoneInQuietUpdates) {
  // A budget that holds the dearest variable: an object's anchor, with a factor in each frame.
  constexpr std::int64_t kBudget = 1500;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    IncrementalSolver solver(withBudget(kBudget));
    MultibodyGraph graph(solver, seed, 2);
    int most_deferred = 0;
    for (int i = 0; i < 20; ++i) {
      graph.addFrame();
      most_deferred = std::max(most_deferred, solver.update().deferred_variables);
    }
    EXPECT_GT(most_deferred, 0);
    EXPECT_LE(most_deferred, solver.counters().variables);
    EXPECT_EQ(finishOverQuietUpdates(solver, kBudget), 0);
    EXPECT_LT(differenceFromBatch(solver), kBudgetTol) << "seed " << seed;
  }
}

/// The variable that costs more than the whole budget is an object's anchor, with a factor in each of
/// twenty frames; all variables together have 372 scalars.
TEST(IncrementalSolverBudget, ABudgetBelowTheWholeGetsThereToo) {
  constexpr std::int64_t kBudget = 300;
  IncrementalSolver solver(withBudget(kBudget));
  MultibodyGraph graph(solver, 1, 2);
  for (int i = 0; i < 20; ++i) {
    graph.addFrame();
    solver.update();
  }
  EXPECT_EQ(finishOverQuietUpdates(solver, kBudget), 0);
  EXPECT_LT(differenceFromBatch(solver), kBudgetTol);
}

TEST(IncrementalSolverBudget, ATimeNextToZeroPutsOffAllButTheNewMeasurement) {
  IncrementalSolver::Params params = withBudget(0);
  params.budget.ms = 1e-9;
  IncrementalSolver solver(params);
  MultibodyGraph graph(solver, 1, 2);
  for (int i = 0; i < 20; ++i) {
    const auto before = solver.graph().factors();
    graph.addFrame();
    const auto asked = scalarsThatNewFactorsAskFor(solver, before);
    const auto& report = solver.update();
    if (i == 0) continue;  // no pace yet
    EXPECT_EQ(report.eliminated_scalars, asked);
    EXPECT_GT(report.deferred_variables, 0);
  }
}

TEST(IncrementalSolverBudget, ANewMeasurementIsNeverPutOff) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    IncrementalSolver solver(withBudget(1));
    MultibodyGraph graph(solver, seed, 2);
    for (int i = 0; i < 15; ++i) {
      graph.addFrame();
      solver.update();
    }
    // The camera's newest pose is measured to a millimeter, 0.1 m from where it stands.
    const VariableId newest = graph.camera().back();
    const SE3 measured = solver.pose(newest) * SE3(Eigen::Matrix3d::Identity(), {0.1, 0, 0});
    solver.addFactor(
        std::make_unique<PriorFactor>(std::array{newest}, PriorModel{measured}, test::isotropicNoise(1e-3, 1e-4)));
    solver.update();
    EXPECT_LT((solver.pose(newest).translation() - measured.translation()).norm(), 5e-3) << "seed " << seed;
    const auto covariance = solver.jointCovariance(std::array{newest});
    ASSERT_TRUE(covariance);
    EXPECT_LT(std::sqrt(covariance->diagonal().head<3>().maxCoeff()), 1.01e-3);
  }
}

/// A path that starts out straight, and whose end is measured.
struct BentPath {
  static constexpr int kPoses = 60;

  explicit BentPath(std::int64_t budget_scalars) : solver(defaultsWithBudget(budget_scalars)) {
    const SE3 step(Eigen::Matrix3d::Identity(), {1, 0, 0});
    for (int k = 0; k < kPoses; ++k) {
      x.push_back(solver.addVariable(k == 0 ? SE3{} : solver.pose(x.back()) * step));
      if (k == 0)
        measure(x[0], SE3{}, test::isotropicNoise(0.01, 0.01));
      else
        solver.addFactor(std::make_unique<MotionFactor>(std::array{x[k - 1], x[k]}, MotionModel{step},
                                                        test::isotropicNoise(0.05, 0.01)));
      solver.update();
    }
  }
  static IncrementalSolver::Params defaultsWithBudget(std::int64_t scalars) {
    IncrementalSolver::Params params;
    params.budget.scalars = scalars;
    return params;
  }
  /// Place of the end when the path has turned as a whole.
  static SE3 endAt(double angle_rad) {
    const Eigen::Matrix3d R = expSO3({0, 0, angle_rad});
    return {R, (kPoses - 1) * R.col(0)};
  }
  std::optional<FactorId> measure(VariableId v, const SE3& mean, const PoseNoise& noise) {
    return solver.addFactor(std::make_unique<PriorFactor>(std::array{v}, PriorModel{mean}, noise));
  }
  double distanceTo(const SE3& end) const { return (solver.pose(x.back()).translation() - end.translation()).norm(); }

  IncrementalSolver solver;
  std::vector<VariableId> x;
};

/// All poses finally turn by far more than their Jacobians are good for.
TEST(IncrementalSolverBudget, JacobiansThatArePutOffLetNothingDiverge) {
  BentPath path(1), unlimited(0);
  std::optional<FactorId> measured;
  SE3 end;
  for (int i = 1; i <= 60; ++i) {
    end = BentPath::endAt(0.02 * i);
    if (measured) path.solver.removeFactor(*measured);
    measured = path.measure(path.x.back(), end, test::isotropicNoise(0.1, 0.1));
    EXPECT_GT(path.solver.update().deferred_variables, 0);
    ASSERT_LT(path.distanceTo(end), 1.0) << "update " << i;
  }
  for (int i = 0; i < 60; ++i) {
    path.solver.update();
    ASSERT_LT(path.distanceTo(end), 1.0) << "quiet update " << i;
  }
  unlimited.measure(unlimited.x.back(), end, test::isotropicNoise(0.1, 0.1));
  for (BentPath* p : {&path, &unlimited}) p->solver.converge(50, 1e-9);
  EXPECT_NEAR(path.solver.counters().chi2, unlimited.solver.counters().chi2, 1e-6);
}

/// The end is measured so far away that linear models hold by no means, and the budget leaves no new Jacobians.
TEST(IncrementalSolverBudget, AStepBeyondItsLinearModelsIsTakenAnewWithAllJacobians) {
  for (const double angle_rad : {0.8, 1.0}) {
    BentPath path(1);
    const SE3 end = BentPath::endAt(angle_rad);
    path.measure(path.x.back(), end, test::isotropicNoise(0.1, 0.1));
    EXPECT_GT(path.solver.update().relinearized_factors, BentPath::kPoses);
    EXPECT_LT(path.distanceTo(end), 1.0);  // 20 m and more with the old Jacobians
    EXPECT_EQ(path.solver.update().relinearized_factors, 0) << "one anew is enough";
  }
}

/// A path whose newest pose is measured in each update, which moves all of it; the linear models stay what they are.
struct MeasuredPath {
  explicit MeasuredPath(std::int64_t spread_scalars) : solver(linear(spread_scalars)) {
    test::RandomPoses random(1);
    const PoseNoise noise{.sqrt_information = 10 * Matrix6d::Identity()};
    std::vector<VariableId> x;
    for (int k = 0; k < 60; ++k) {
      const Eigen::Matrix3d ahead = Eigen::Matrix3d::Identity();
      const SE3 step = SE3(ahead, {1, 0, 0}) * random.pose(0.1, 0.01), at(ahead, {1.0 * k, 0, 0});
      x.push_back(solver.addVariable(at));
      if (k > 0) solver.addFactor(std::make_unique<MotionFactor>(std::array{x[k - 1], x[k]}, MotionModel{step}, noise));
      const SE3 seen = at * random.pose(0.3, 0.02);
      solver.addFactor(std::make_unique<PriorFactor>(std::array{x[k]}, PriorModel{seen}, noise));
      const auto& report = solver.update();
      most_below = std::max(most_below, report.substituted_scalars - report.eliminated_scalars);
      most_waiting = std::max(most_waiting, report.waiting_scalars);
    }
  }
  static IncrementalSolver::Params linear(std::int64_t spread_scalars) {
    IncrementalSolver::Params params = kExact;
    params.relinearization = {
        .mismatch_tolerance = 1e9, .jacobian_drift_sigmas = 1e9, .relinearize_rad = 1e9, .leisurely_rad = 1e9};
    params.spread_scalars = spread_scalars;
    return params;
  }
  double differenceFrom(const IncrementalSolver& other) const {
    double difference = 0;
    for (const VariableId v : solver.graph().variables())
      difference = std::max(difference, (solver.pose(v).inverse() * other.pose(v)).log().norm());
    return difference;
  }

  IncrementalSolver solver;
  std::int64_t most_below = 0;
  std::int64_t most_waiting = 0;
};

TEST(IncrementalSolverSpread, OldPosesFollowInLaterUpdatesAndGetToTheSameSolution) {
  constexpr std::int64_t kSpread = 60;
  constexpr int kClique = 12;  // scalars at most that a clique has as frontals
  const MeasuredPath at_once(0);
  MeasuredPath spread(kSpread);
  EXPECT_EQ(at_once.most_waiting, 0);
  EXPECT_GT(at_once.most_below, 3 * kSpread);
  EXPECT_GT(spread.most_waiting, 0);
  EXPECT_LE(spread.most_below, kSpread + kClique);
  EXPECT_GT(spread.differenceFrom(at_once.solver), 1e-6);
  for (int i = 0; i < 100; ++i) spread.solver.update();
  EXPECT_EQ(spread.solver.update().waiting_scalars, 0);
  EXPECT_LT(spread.differenceFrom(at_once.solver), 1e-9);
}

TEST(IncrementalSolverEveryN, ReachesTheBatchSolutionInItsBatchSteps) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    IncrementalSolver::Params params = kExact;
    params.policy = IncrementalSolver::Policy::kEveryN;
    params.batch_every_updates = 4;
    IncrementalSolver solver(params);
    MultibodyGraph graph(solver, seed, 2);
    for (int i = 0; i < 30; ++i) {
      graph.addFrame();
      solver.update();
      if (i >= 15) solver.retire(graph.takeOldest());
    }
    for (int i = 0; i < 4 * 12; ++i) solver.update();
    EXPECT_LT(differenceFromBatch(solver), 1e-8) << "seed " << seed;
  }
}

TEST(IncrementalSolverEveryN, KeepsItsLinearModelsBetweenBatchSteps) {
  IncrementalSolver::Params params = kExact;
  params.policy = IncrementalSolver::Policy::kEveryN;
  params.batch_every_updates = 1000;
  IncrementalSolver solver(params);
  MultibodyGraph graph(solver, 1, 2);
  for (int i = 0; i < 20; ++i) {
    graph.addFrame();
    const auto& report = solver.update();
    EXPECT_EQ(report.relinearized_variables + report.relinearized_factors + report.corrected_factors, 0);
  }
  // What is left is the minimum of the linear models: the gradient of their sum vanishes at x.
  const DenseSystem dense(solver.graph());
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(dense.size()), scale = gradient;
  for (const FactorId f : solver.graph().factors()) {
    std::vector<double> x;
    for (const VariableId v : solver.graph().variablesOf(f)) {
      const auto& coordinates = solver.graph().states()[v].x;
      x.insert(x.end(), coordinates.begin(), coordinates.begin() + solver.graph().sizeOf(v));
    }
    const auto term = solver.graph().models().term(f);
    const auto n = static_cast<Eigen::Index>(x.size());
    const auto at = dense.entries(solver.graph().variablesOf(f));
    const Eigen::VectorXd r = term.leftCols(n) * Eigen::Map<Eigen::VectorXd>(x.data(), n) + term.col(n);
    gradient(at) += term.leftCols(n).transpose() * r;
    scale(at) += term.leftCols(n).cwiseAbs().transpose() * r.cwiseAbs();
  }
  EXPECT_LT((gradient.array() / (scale.array() + 1)).abs().maxCoeff(), 1e-8);
}

}  // namespace
}  // namespace motorcade
