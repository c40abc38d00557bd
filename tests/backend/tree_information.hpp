#pragma once

#include <Eigen/Core>

#include "backend/elimination/elimination_tree.hpp"
#include "tests/backend/dense_system.hpp"

/// The linear system [H g; g^T *] in the coordinates of a graph, in a dense system's order of variables, from two
/// sides. The last corner, which no solution depends on, is zero.
namespace motorcade::test {

/// Summed up from the linear models of the factors.
Eigen::MatrixXd informationOfFactors(const FactorGraph& graph, const DenseSystem& dense);

/// Memory of the matrices of its cliques.
std::size_t matrixBytes(const EliminationTree& tree);

/// [R d]^T [R d] of the cliques.
Eigen::MatrixXd informationOfTree(const EliminationTree& tree, const DenseSystem& dense);

}  // namespace motorcade::test
