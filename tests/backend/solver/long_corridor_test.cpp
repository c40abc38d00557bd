#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include <gtest/gtest.h>

#include "backend/graph/relative_pose_factor.hpp"
#include "backend/solver/incremental_solver.hpp"
#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

/// A robot drives along the corridors of a building, a meter a step, and now and then knows a place again: long chains
/// that few closures bend, each pose by very little.
class Corridors {
 public:
  Corridors(IncrementalSolver& solver, std::uint64_t seed) : solver_(solver), noise_(seed) {
    poses_.push_back(solver_.addVariable(SE2{}));
    solver_.addFactor(std::make_unique<PriorFactorSE2>(poses_[0], SE2{}, Eigen::Matrix3d(1e6 * information_)));
    solver_.update();
  }

  void drive(std::size_t poses) {
    while (poses_.size() < poses) {
      const double corner_rad = left_ == 0 ? std::copysign(std::numbers::pi / 2, noise_.uniform(-1, 1)) : 0;
      if (left_-- == 0) left_ = static_cast<int>(noise_.uniform(40, 160));
      step(SE2(corner_rad, {1, 0}));
    }
  }
  int closures() const { return closures_; }

 private:
  static constexpr int kBetweenClosures = 10, kOldPlace = 50;  // steps
  const Eigen::Vector3d sigma_{0.02, 0.02, 0.01};
  const Eigen::Matrix3d information_{sigma_.cwiseAbs2().cwiseInverse().asDiagonal()};

  SE2 measured(const SE2& motion) { return motion * SE2::exp(noise_.gaussian(sigma_)); }

  void step(const SE2& motion) {
    truth_.push_back(truth_.back() * motion);
    const SE2 odometry = measured(motion);
    poses_.push_back(solver_.addVariable(std::get<SE2>(solver_.estimate(poses_.back())) * odometry));
    const std::size_t now = poses_.size() - 1;
    solver_.addFactor(std::make_unique<RelativePoseFactorSE2>(poses_[now - 1], poses_[now], odometry, information_));
    close(now);
    solver_.update();
  }

  void close(std::size_t now) {
    const Eigen::Vector2d p = truth_[now].translation();
    const auto place = std::pair(std::lround(p.x()), std::lround(p.y()));
    const auto [known, is_new] = first_at_.emplace(place, now);
    if (is_new || now - known->second < kOldPlace || now - closed_ < kBetweenClosures) return;
    const SE2 motion = measured(truth_[known->second].inverse() * truth_[now]);
    solver_.addFactor(
        std::make_unique<RelativePoseFactorSE2>(poses_[known->second], poses_[now], motion, information_));
    closed_ = now;
    ++closures_;
  }

  IncrementalSolver& solver_;
  test::Noise noise_;
  std::vector<SE2> truth_{SE2{}};
  std::vector<VariableId> poses_;
  std::map<std::pair<long, long>, std::size_t> first_at_;
  std::size_t closed_ = 0;
  int left_ = 40, closures_ = 0;
};

double chi2(const IncrementalSolver& solver) {
  const FactorGraph& graph = solver.graph();
  double sum = 0;
  for (const FactorId f : graph.factors()) {
    std::vector<Value> values;
    for (const VariableId v : graph.factor(f).variables()) values.push_back(solver.estimate(v));
    std::vector<const Value*> pointers;
    for (const Value& value : values) pointers.push_back(&value);
    Eigen::VectorXd r(graph.factor(f).rows());
    graph.factor(f).residual(pointers, r);
    sum += r.squaredNorm();
  }
  return sum;
}

/// Of chi2 over that of the converged solution, after a drive of so many poses.
double excess(const FluidRelinearization::Params& params, std::uint64_t seed) {
  IncrementalSolver solver({.relinearization = params, .budget = {}});
  Corridors corridors(solver, seed);
  corridors.drive(4000);
  EXPECT_GT(corridors.closures(), 3);
  const double incremental = chi2(solver);
  solver.converge(20, 1e-9);
  return incremental / chi2(solver) - 1;
}

TEST(LongCorridors, EndNearTheOptimumAsWhatHardlyTurnedIsRelinearizedAtLeisure) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const double attended = excess({}, seed), neglected = excess({.leisurely_rad = 0.05}, seed);
    EXPECT_LT(attended, 3e-4) << "seed " << seed;
    EXPECT_LT(attended, 0.5 * neglected) << "seed " << seed;
  }
}

}  // namespace
}  // namespace motorcade
