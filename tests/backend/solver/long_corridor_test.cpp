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

/// Two sides of a street, a meter a step, which one closure in its middle ties together; then straight on.
void driveWithOneClosure(IncrementalSolver& solver, std::uint64_t seed, int poses) {
  test::Noise noise(seed);
  const Eigen::Vector3d sigma(0.05, 0.05, 0.03);
  const Eigen::Matrix3d information = sigma.cwiseAbs2().cwiseInverse().asDiagonal();
  const auto measured = [&](const SE2& motion) { return motion * SE2::exp(noise.gaussian(sigma)); };
  std::vector<VariableId> x{solver.addVariable(SE2{})};
  std::vector<SE2> truth{SE2{}};
  solver.addFactor(std::make_unique<PriorFactorSE2>(x[0], SE2{}, Eigen::Matrix3d(1e8 * Eigen::Matrix3d::Identity())));
  for (int k = 1; k < poses; ++k) {
    const bool corner = k <= 1000 && k % 250 == 0;  // round a block, and over the first pose again
    truth.push_back(truth.back() * SE2(corner ? std::numbers::pi / 2 : 0, {1, 0}));
    const SE2 odometry = measured(truth[k - 1].inverse() * truth[k]);
    x.push_back(solver.addVariable(std::get<SE2>(solver.estimate(x.back())) * odometry));
    solver.addFactor(std::make_unique<RelativePoseFactorSE2>(x[k - 1], x[k], odometry, information));
    if (k == 1000)
      solver.addFactor(
          std::make_unique<RelativePoseFactorSE2>(x[0], x[k], measured(truth[0].inverse() * truth[k]), information));
    solver.update();
  }
}

double chi2(const IncrementalSolver& solver) {
  const FactorGraph& graph = solver.graph();
  double sum = 0;
  for (const FactorId f : graph.factors()) {
    std::vector<Value> values;
    for (const VariableId v : graph.variablesOf(f)) values.push_back(solver.estimate(v));
    std::vector<const Value*> pointers;
    for (const Value& value : values) pointers.push_back(&value);
    Eigen::VectorXd r(graph.models().factor(f).rows());
    graph.models().jacobianFactor(f)->residual(pointers, r);
    sum += r.squaredNorm();
  }
  return sum;
}

/// Ratio of chi2 to that of the converged solution, after a drive of so many poses.
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
    const double attended = excess({}, seed), neglected = excess({.leisurely_rad = 0.05, .rest_flops = 0}, seed);
    EXPECT_LT(attended, 3e-4) << "seed " << seed;
    EXPECT_LT(attended, 0.5 * neglected) << "seed " << seed;
  }
}

TEST(LongCorridors, PosesThatHardlyTurnedAreRelinearizedAtRest) {
  double worst_neglected = 0;
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    const auto excessOf = [&](const FluidRelinearization::Params& params) {
      IncrementalSolver solver({.relinearization = params, .budget = {}});
      driveWithOneClosure(solver, seed, 2000);
      const double incremental = chi2(solver);
      solver.converge(20, 1e-9);
      return incremental / chi2(solver) - 1;
    };
    EXPECT_LT(excessOf({}), 1e-3) << "seed " << seed;
    worst_neglected = std::max(worst_neglected, excessOf({.rest_flops = 0}));
  }
  EXPECT_GT(worst_neglected, 1e-3);
}

}  // namespace
}  // namespace motorcade
