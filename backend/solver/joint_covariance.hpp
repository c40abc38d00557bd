#pragma once

#include <optional>
#include <span>

#include <Eigen/Core>

#include "backend/elimination/elimination_tree.hpp"
#include "backend/graph/factor_graph.hpp"

namespace motorcade {

/// Covariance of J x from R, where x are the stacked right perturbations of the variables. Empty when the system is
/// singular there. Costs as much as the cliques from the variables up to the root, and less where J has few rows and
/// those of old variables come first.
std::optional<Eigen::MatrixXd> jointCovariance(const FactorGraph& graph, const EliminationTree& tree,
                                               std::span<const VariableId> variables,
                                               const Eigen::Ref<const Eigen::MatrixXd>& J);

}  // namespace motorcade
