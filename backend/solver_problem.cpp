#include "backend/solver_problem.hpp"

#include <array>
#include <cmath>
#include <cstdio>

namespace motorcade {
namespace {

/// "y (0.80) and yaw (-0.60)", leaving out what is next to nothing.
std::string axesOf(const SmallVector& direction, const Value& value) {
  static constexpr std::array<const char*, 6> kSpace{"x", "y", "z", "rotation about x", "rotation about y", "rotation about z"};
  static constexpr std::array<const char*, 3> kPlane{"x", "y", "rotation"};
  std::string text;
  for (Eigen::Index i = 0; i < direction.size(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    if (std::abs(direction[i]) < 0.05) continue;
    std::string axis = "component " + std::to_string(i);
    if (std::holds_alternative<SE3>(value)) axis = kSpace[k];
    if (std::holds_alternative<SE2>(value)) axis = kPlane[k];
    char share[16] = "";
    if (std::abs(direction[i]) < 0.999) std::snprintf(share, sizeof(share), " (%.2f)", direction[i]);
    text.append(text.empty() ? "" : " and ").append(axis).append(share);
  }
  return text;
}

}  // namespace

std::string describe(const SolverProblem& problem, const FactorGraph& graph, const std::function<std::string(VariableId)>& name) {
  using Kind = SolverProblem::Kind;
  const auto axes = [&] { return axesOf(problem.direction, graph.estimate(problem.variable)); };
  switch (problem.kind) {
    case Kind::kUnconstrained:
      return name(problem.variable) + " is not constrained along " + axes() + ": its estimate stays there";
    case Kind::kBadlyConditioned:
      return name(problem.variable) + " is badly conditioned along " + axes() + ": rounding spoils its estimate there";
    case Kind::kNotFinite:
      return "a factor on " + name(problem.variable) + " is not finite: left out";
    case Kind::kUnknownVariable:
      return "a factor names a variable that is not in the graph: left out";
    case Kind::kRepeatedVariable:
      return "a factor names " + name(problem.variable) + " twice: left out";
  }
  return {};
}

}  // namespace motorcade
