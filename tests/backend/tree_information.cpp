#include "tests/backend/tree_information.hpp"

#include <vector>

#include "tests/backend/unpacked.hpp"

namespace motorcade::test {

Eigen::MatrixXd informationOfFactors(const FactorGraph& graph, const DenseSystem& dense) {
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(dense.size() + 1, dense.size() + 1);
  for (const FactorId f : graph.factors()) {
    auto at = dense.entries(graph.variablesOf(f));
    at.push_back(dense.size());
    if (graph.models().isJacobian(f))
      system(at, at) += graph.models().term(f).transpose() * graph.models().term(f);
    else
      system(at, at) += unpacked(graph.models().information(f).H, graph.models().information(f).g_c);
  }
  system(dense.size(), dense.size()) = 0;
  return system;
}

std::size_t matrixBytes(const EliminationTree& tree) {
  std::size_t doubles = 0;
  for (const int c : tree.cliques())
    doubles += tree[c].panelLength() + (tree[c].update_matrix ? tree[c].updateMatrixLength() : 0) +
               static_cast<std::size_t>(tree[c].separatorSize());
  return doubles * sizeof(double);
}

Eigen::MatrixXd informationOfTree(const EliminationTree& tree, const DenseSystem& dense) {
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(dense.size() + 1, dense.size() + 1);
  std::vector<int> open = tree.roots();
  while (!open.empty()) {
    const Clique& clique = tree[open.back()];
    open.pop_back();
    for (int child = clique.first_child; child >= 0; child = tree[child].next_sibling) open.push_back(child);
    auto at = dense.entries(clique.variables);
    at.push_back(dense.size());
    Eigen::MatrixXd L = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>>(
        clique.panel, clique.size + 1, clique.frontal_size, Eigen::OuterStride<>(clique.panelStride()));
    L.topRows(clique.frontal_size).triangularView<Eigen::StrictlyUpper>().setZero();
    system(at, at) += L * L.transpose();
  }
  system(dense.size(), dense.size()) = 0;
  return system;
}

}  // namespace motorcade::test
