#include <algorithm>

#include <gtest/gtest.h>

#include "backend/solver/incremental_solver.hpp"
#include "tests/backend/random_graphs.hpp"

/// Tests that an update takes no longer than its budget where loops close all the time, in counted work, and that what
/// waits comes through.
namespace motorcade {
namespace {

constexpr int kTorusRows = 24, kTorusColumns = 36;
constexpr double kTorusSigma_m = 0.05, kTorusSigma_rad = 0.01;

/// Poses along a torus, a row after the other. Each is measured from the one before and from its neighbor of the row
/// before; those of the last row from those of the first one, too.
class Torus {
 public:
  explicit Torus(const IncrementalSolver::Params& params) : solver_(params) {}

  /// Adds a pose with its edges, and updates.
  const IncrementalSolver::Report& next() {
    const int k = static_cast<int>(poses_.size());
    if (k == 0) {
      poses_.push_back(solver_.addVariable(truth(0)));
      solver_.addFactor(
          std::make_unique<PriorFactor>(std::array{poses_[0]}, PriorModel{truth(0)}, test::isotropicNoise(1e-3, 1e-3)));
    } else {
      const SE3 step = measured(k - 1, k);
      poses_.push_back(solver_.addVariable((solver_.pose(poses_.back()) * step).normalized()));
      add(k - 1, k, step);
    }
    if (k >= kTorusColumns) add(k - kTorusColumns, k, measured(k - kTorusColumns, k));
    if (const int first = k - (kTorusRows - 1) * kTorusColumns; first >= 0) add(first, k, measured(first, k));
    return solver_.update();
  }
  bool atEnd() const { return poses_.size() == std::size_t{kTorusRows} * kTorusColumns; }
  IncrementalSolver& solver() { return solver_; }
  double chi2() const {
    double sum = 0;
    for (const auto& [from, to, Z] : edges_) {
      Vector6d xi = (Z.inverse() * solver_.pose(poses_[from]).inverse() * solver_.pose(poses_[to])).log();
      xi.head<3>() /= kTorusSigma_m, xi.tail<3>() /= kTorusSigma_rad;
      sum += xi.squaredNorm();
    }
    return sum;
  }

 private:
  struct Edge {
    int from, to;
    SE3 Z;
  };

  static SE3 truth(int k) {
    const int column = k % kTorusColumns, row = k / kTorusColumns;
    const double along = 2 * M_PI * column / kTorusColumns, around = 2 * M_PI * row / kTorusRows;
    const SE3 outwards(Eigen::Matrix3d::Identity(), {8, 0, 0}), to_surface(Eigen::Matrix3d::Identity(), {4, 0, 0});
    const Eigen::Vector3d in_place = Eigen::Vector3d::Zero();
    return SE3(expSO3({0, 0, along}), in_place) * outwards * SE3(expSO3({0, around, 0}), in_place) * to_surface;
  }
  SE3 measured(int from, int to) {
    return truth(from).inverse() * truth(to) * random_.pose(kTorusSigma_m, kTorusSigma_rad);
  }
  void add(int from, int to, const SE3& Z) {
    edges_.push_back({from, to, Z});
    solver_.addFactor(std::make_unique<MotionFactor>(std::array{poses_[from], poses_[to]}, MotionModel{Z},
                                                     test::isotropicNoise(kTorusSigma_m, kTorusSigma_rad)));
  }

  IncrementalSolver solver_;
  std::vector<VariableId> poses_;
  std::vector<Edge> edges_;
  test::RandomPoses random_{1};
};

IncrementalSolver::Params withFlops(double flops) {
  IncrementalSolver::Params params;
  params.budget.flops = flops;
  return params;
}

struct TorusWork {
  double most_flops = 0;
  int most_waiting = 0;
};
TorusWork driveAround(Torus& torus) {
  TorusWork work;
  while (!torus.atEnd()) {
    const auto& report = torus.next();
    work.most_flops = std::max(work.most_flops, report.flops);
    work.most_waiting = std::max(work.most_waiting, report.waiting_factors);
  }
  return work;
}

constexpr double kTorusFlops = 1e8, kOverrun = 1.2;

TEST(CountedBudget, HoldsInEachUpdateOfATorusAndWhatWaitsComesThrough) {
  Torus unlimited(withFlops(0)), torus(withFlops(kTorusFlops));
  EXPECT_GT(driveAround(unlimited).most_flops, 3 * kTorusFlops);
  const TorusWork work = driveAround(torus);
  EXPECT_LE(work.most_flops, kOverrun * kTorusFlops);
  EXPECT_GT(work.most_waiting, 0);
  int updates = 0;
  double most_flops = 0;
  for (bool settled = false; !settled && updates < 2000; ++updates) {
    const auto& report = torus.solver().update();
    most_flops = std::max(most_flops, report.flops);
    settled = report.settled();
  }
  EXPECT_LE(most_flops, kOverrun * kTorusFlops);
  EXPECT_LE(updates, 400);
  EXPECT_NEAR(torus.chi2(), unlimited.chi2(), 0.02 * unlimited.chi2());
}

TEST(CountedBudget, GivesTheSameBitsWheneverItRuns) {
  Torus first(withFlops(kTorusFlops)), second(withFlops(kTorusFlops));
  driveAround(first), driveAround(second);
  EXPECT_EQ(first.chi2(), second.chi2());
}

/// Each update brings the oldest closure that waits at least a clique nearer, however small the budget.
TEST(CountedBudget, LetsEachClosureInAfterSomeUpdates) {
  Torus torus(withFlops(1));
  driveAround(torus);
  int waiting = torus.solver().update().waiting_factors;
  ASSERT_GT(waiting, 5);
  constexpr int kUpdates = 60;  // more than a path has cliques
  for (int i = 0; i < 5; ++i) {
    for (int k = 0; k < kUpdates; ++k) torus.solver().update();
    const int now = torus.solver().update().waiting_factors;
    EXPECT_LT(now, waiting);
    waiting = now;
  }
}

}  // namespace
}  // namespace motorcade
