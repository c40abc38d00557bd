#pragma once

#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/backend/dense_system.hpp"
#include "tests/backend/space_fixtures.hpp"
#include "tests/support/matchers.hpp"

/// Broken graphs over each kind of variable: the solver's reports on them, and its solution of their good rest, which
/// must be as if the broken part were not there.
namespace motorcade::test {

inline constexpr double kSame = 1e-8;  // of two solvers that both have converged

inline std::string nameOf(VariableId v) { return std::string("v").append(std::to_string(v.value)); }

inline std::vector<SolverProblem::Kind> kindsOf(const std::vector<SolverProblem>& problems) {
  std::vector<SolverProblem::Kind> kinds;
  for (const auto& problem : problems) kinds.push_back(problem.kind);
  return kinds;
}

/// A graph of noisy relative measurements: each variable to the one before, and some to others.
template <class Space>
class Chain {
 public:
  Chain(IncrementalSolver& solver, std::uint64_t seed) : solver_(solver), random_(seed) {}

  VariableId add(bool joined = true) {
    const SmallVector step = random_.noise(1.0, 0.5).template head<Space::kSize>();
    truth_.push_back(truth_.empty() ? Space::origin() : Space::moved(truth_.back(), step));
    ids_.push_back(solver_.addVariable(Space::moved(truth_.back(), noise(0.05))));
    const std::size_t n = ids_.size();
    if (joined && n > 1) join(n - 2, n - 1);
    if (joined && n > 3 && n % 2 == 0) join(n - 4, n - 1);
    return ids_.back();
  }
  void addMany(int count) {
    for (int i = 0; i < count; ++i) add();
  }
  void join(std::size_t i, std::size_t j) {
    const Value Z = Space::moved(Space::between(truth_[i], truth_[j]), noise(0.02));
    solver_.addFactor(Space::relative(ids_[i], ids_[j], Z, 100));
  }
  std::optional<FactorId> hold(std::size_t i) { return solver_.addFactor(Space::prior(ids_[i], truth_[i], 1e4)); }
  SmallVector noise(double sigma) { return random_.noise(sigma, sigma).template head<Space::kSize>(); }

  const std::vector<VariableId>& ids() const { return ids_; }
  const std::vector<Value>& truth() const { return truth_; }

 private:
  IncrementalSolver& solver_;
  RandomPoses random_;
  std::vector<VariableId> ids_;
  std::vector<Value> truth_;
};

template <class Space>
class BrokenGraph : public testing::Test {
 protected:
  static constexpr int kSize = Space::kSize;
  /// Solves, and returns the problems found.
  std::vector<SolverProblem> problemsFound() {
    auto problems = solver().update().problems;
    for (int i = 0; i < 10; ++i) {
      const auto& later = solver().update().problems;
      EXPECT_THAT(later, testing::IsEmpty())
          << "reported again without a change: " << (later.empty() ? "" : describe(later[0], solver().graph(), nameOf));
    }
    return problems;
  }
  /// Solution of the good graph alone.
  std::vector<Value> goodSolution(int count, std::uint64_t seed) {
    IncrementalSolver solver(kExact);
    Chain<Space> chain(solver, seed);
    chain.addMany(count);
    chain.hold(0);
    for (int i = 0; i < 10; ++i) EXPECT_THAT(solver.update().problems, testing::IsEmpty());
    std::vector<Value> values;
    for (const VariableId v : chain.ids()) values.push_back(solver.estimate(v));
    return values;
  }
  void expectSolvedAs(const std::vector<Value>& expected, const std::vector<VariableId>& ids) {
    for (std::size_t i = 0; i < expected.size(); ++i)
      EXPECT_THAT(displacement(expected[i], solver().estimate(ids[i])),
                  IsNear(SmallVector(SmallVector::Zero(kSize)), kSame))
          << "variable " << i;
  }
  static std::vector<SmallVector> allDirections() {
    std::vector<SmallVector> directions;
    for (int i = 0; i < kSize; ++i) directions.push_back(SmallVector::Unit(kSize, i));
    return directions;
  }
  static SmallVector slanted() {
    SmallVector direction = SmallVector::Zero(kSize);
    direction[0] = 0.6, direction[1] = 0.8;
    return direction;
  }

  IncrementalSolver& solver() { return *solver_; }
  void restart() { solver_ = std::make_unique<IncrementalSolver>(kExact); }

 private:
  std::unique_ptr<IncrementalSolver> solver_ = std::make_unique<IncrementalSolver>(kExact);
};

using Spaces = testing::Types<Space3, Space2, Vectors>;

}  // namespace motorcade::test
