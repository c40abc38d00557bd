#pragma once

#include <vector>

#include "backend/graph/factor_graph.hpp"
#include "tests/backend/random_factors.hpp"

namespace motorcade::test {

constexpr double kResidualRounding = 1e-9;  // of whitened residuals of some hundreds

/// Four variables of a world, and factors between them.
struct GraphScene {
  explicit GraphScene(std::uint64_t seed, RandomWorld::Kind kind) : world(seed, kind) {
    for (int i = 0; i < 4; ++i) variables.push_back(world.addVariable(graph));
    for (const VariableId v : variables) factors.push_back(*graph.addFactor(world.prior(v)));
    for (std::size_t i = 0; i < 6; ++i)
      factors.push_back(*graph.addFactor(world.between(variables[i % 4], variables[(i + 1 + i / 4) % 4], true)));
  }

  /// Moves the coordinates of all variables, and the estimates with them.
  void move(double sigma) {
    for (const VariableId v : variables) {
      for (int i = 0; i < graph.sizeOf(v); ++i) states[v].x[i] += world.noise().gaussian(sigma);
      states.apply(v);
    }
  }
  std::vector<Value> estimatesOf(const Factor& factor) const {
    std::vector<Value> values;
    for (const VariableId v : factor.variables()) values.push_back(states.estimate(v));
    return values;
  }
  Eigen::VectorXd coordinatesOf(const Factor& factor) const {
    std::vector<double> x;
    for (const VariableId v : factor.variables())
      x.insert(x.end(), states[v].x.begin(), states[v].x.begin() + graph.sizeOf(v));
    return Eigen::Map<Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
  }
  /// Residual of the linear model at the present coordinates.
  Eigen::VectorXd modeled(FactorId f) const {
    const auto term = models.term(f);
    return term.leftCols(term.cols() - 1) * coordinatesOf(models.factor(f)) + term.col(term.cols() - 1);
  }

  RandomWorld world;
  FactorGraph graph;
  VariableStates& states = graph.states();
  LinearModels& models = graph.models();
  std::vector<VariableId> variables;
  std::vector<FactorId> factors;
};

template <class Check>
void forAllKinds(const Check& check) {
  for (const auto kind : RandomWorld::kKinds)
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
      GraphScene scene(seed, kind);
      check(scene);
    }
}

}  // namespace motorcade::test
