#include "backend/solver/solver_problem.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>

namespace motorcade {
namespace {

using Kind = SolverProblem::Kind;
using NameOf = std::function<std::string(VariableId)>;

std::string counted(std::int64_t n, const std::string& thing) {
  return std::to_string(n) + " " + thing + (n == 1 ? "" : "s");
}

/// "a", "a and b", "a, b and c"
std::string listed(const std::vector<std::string>& items) {
  std::string text;
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (i > 0) text += i + 1 == items.size() ? " and " : ", ";
    text += items[i];
  }
  return text;
}

std::string axisName(const std::optional<Value>& value, Eigen::Index i) {
  static constexpr std::array<const char*, 6> kSpace{
      "x", "y", "z", "rotation about x", "rotation about y", "rotation about z"};
  static constexpr std::array<const char*, 3> kPlane{"x", "y", "rotation"};
  const auto k = static_cast<std::size_t>(i);
  if (value && std::holds_alternative<SE3>(*value)) return kSpace[k];
  if (value && std::holds_alternative<SE2>(*value)) return kPlane[k];
  return "component " + std::to_string(i);
}

/// "x", or "(0.60 x + 0.80 y)", leaving out what is next to nothing.
std::string nameOfDirection(const SmallVector& direction, const std::optional<Value>& value) {
  std::string text;
  for (Eigen::Index i = 0; i < direction.size(); ++i) {
    if (std::abs(direction[i]) < 0.005) continue;
    if (std::abs(direction[i]) > 0.9999) return axisName(value, i);
    if (!text.empty())
      text.append(direction[i] < 0 ? " - " : " + ");
    else if (direction[i] < 0)
      text.append("-");
    char share[16];
    std::snprintf(share, sizeof(share), "%.2f ", std::abs(direction[i]));
    text.append(share).append(axisName(value, i));
  }
  return std::string("(").append(text).append(")");
}

/// "along x and rotation about z", "in any direction"
std::string along(const SolverProblem& problem, const FactorGraph& graph) {
  std::optional<Value> value;
  if (graph.contains(problem.variable)) value = graph.states().estimate(problem.variable);
  if (problem.directions.empty()) return "somewhere";
  if (problem.directions.size() == static_cast<std::size_t>(problem.directions.front().size()))
    return "in any direction";
  std::vector<std::string> names;
  for (const SmallVector& direction : problem.directions) names.push_back(nameOfDirection(direction, value));
  return "along " + listed(names);
}

/// "its 2 factors join it to pose 3 and pose 5"
std::string touching(const SolverProblem& problem, const FactorGraph& graph, const NameOf& name) {
  constexpr std::size_t kMostNames = 5;
  if (problem.factors.empty()) return "no factor touches it";
  std::vector<VariableId> others;
  for (const FactorId f : problem.factors) {
    if (!graph.contains(f)) continue;
    for (const VariableId v : graph.variablesOf(f))
      if (v != problem.variable && std::ranges::find(others, v) == others.end()) others.push_back(v);
  }
  const std::string factors = "its " + counted(static_cast<std::int64_t>(problem.factors.size()), "factor");
  if (others.empty()) return factors + (problem.factors.size() == 1 ? " touches it alone" : " touch it alone");
  std::vector<std::string> names;
  for (std::size_t i = 0; i < std::min(others.size(), kMostNames); ++i) names.push_back(name(others[i]));
  if (others.size() > kMostNames)
    names.push_back(counted(static_cast<std::int64_t>(others.size() - kMostNames), "other"));
  return factors + (problem.factors.size() == 1 ? " joins it to " : " join it to ") + listed(names);
}

/// "pose 3 and 2 others that move with it"
std::string moving(const SolverProblem& problem, const NameOf& name) {
  if (problem.moving_variables <= 1) return name(problem.variable);
  return name(problem.variable) + " and " + counted(problem.moving_variables - 1, "other") + " that move with it";
}

std::string describePart(const SolverProblem& problem, const FactorGraph& graph, const NameOf& name) {
  const std::string variable = name(problem.variable);
  const bool alone = problem.part_variables <= 1;
  const std::string held = ": " + variable + (alone ? " stays" : " is kept") + " where it is; ";
  if (problem.kind == Kind::kMissingPrior) {
    if (alone) {
      const std::string where = "nothing holds " + variable + " " + along(problem, graph);
      return where + held + touching(problem, graph, name) + ": add a prior on it";
    }
    return "nothing holds the " + counted(problem.part_variables, "variable") + " connected with " + variable +
           ", they can move together " + along(problem, graph) + held + "add a prior on one of them";
  }
  if (alone)
    return variable + " is disconnected from the rest, no factor touches it" + held +
           "add a factor that joins it to the rest, or drop it";
  return "the " + counted(problem.part_variables, "variable") + " connected with " + variable +
         " are disconnected from the rest, they can move together " + along(problem, graph) + held +
         "add a factor that joins them to the rest, or a prior on one of them";
}

/// "a factor on pose 3 and pose 4"
std::string describeFactor(const SolverProblem& problem, const NameOf& name) {
  std::vector<std::string> names{name(problem.variable)};
  for (const VariableId v : problem.others) names.push_back(name(v));
  return "a factor on " + listed(names);
}

}  // namespace

std::string_view nameOf(SolverProblem::Kind kind) {
  static constexpr std::array<std::string_view, 8> kNames{"unconstrained",     "missing_prior",    "disconnected_part",
                                                          "badly_conditioned", "indefinite",       "not_finite",
                                                          "unknown_variable",  "repeated_variable"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::string describe(const SolverProblem& problem, const FactorGraph& graph, const NameOf& name) {
  const auto where = [&] { return std::string(" ").append(along(problem, graph)).append(": "); };
  const auto factors = [&] { return touching(problem, graph, name); };
  const std::string are = problem.moving_variables > 1 ? " are" : " is";
  switch (problem.kind) {
    case Kind::kMissingPrior:
    case Kind::kDisconnectedPart:
      return describePart(problem, graph, name);
    case Kind::kUnconstrained:
      return moving(problem, name) + are + " not constrained" + where() + factors() +
             "; kept where it is: add a factor that sees it, or a prior";
    case Kind::kBadlyConditioned:
      return moving(problem, name) + are + " badly conditioned" + where() +
             "next to the rest of what its factors say, rounding eats the result; " + factors() +
             ": bring their information closer together, or add a prior";
    case Kind::kIndefinite:
      return moving(problem, name) + (problem.moving_variables > 1 ? " have" : " has") + " negative information" +
             where() + factors() + "; kept where it is: make the information of every factor positive semidefinite";
    case Kind::kNotFinite:
      return describeFactor(problem, name) +
             " is not finite, or too large to square: left out; correct its measurement or its information";
    case Kind::kUnknownVariable:
      return describeFactor(problem, name) +
             " names a variable that is not in the graph: left out; add the variable first";
    case Kind::kRepeatedVariable:
      return describeFactor(problem, name) +
             " names a variable twice: left out; join two different variables, or state it as a factor of one";
  }
  return {};
}

}  // namespace motorcade
