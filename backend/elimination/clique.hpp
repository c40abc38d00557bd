#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "backend/elimination/dense_kernels.hpp"
#include "backend/graph/packed_triangle.hpp"
#include "backend/graph/variable.hpp"

namespace motorcade {

/// A group of variables that are eliminated together: p(frontals | separator) in square-root form. Matrices are
/// column-major, their leading dimensions padded as the dense kernels want them.
struct Clique {
  int parent = -1, first_child = -1, next_sibling = -1, previous_sibling = -1;
  std::vector<VariableId> variables;  // frontals, then the separator
  std::vector<int> row_in_parent;     // per variable of the separator: its first scalar among the parent's
  std::vector<FactorId> factors;      // whose first variable in elimination order is a frontal
  int frontals = 0;
  int frontal_size = 0, size = 0;  // scalars: of the frontals, of all variables
  /// (size + 1) x frontal_size: columns are the rows of [R S d], so R^T above, S^T, and d^T last.
  double* panel = nullptr;
  std::vector<int> singular;  // frontal scalars without information
  /// Update matrix H, packed, and contribution g to the right-hand side. Elimination leaves both on the separator, and
  /// the parent's front gathers them. H is null where it was given back.
  double *update_matrix = nullptr, *contribution = nullptr;
  bool made_again = false;    // H, for the parent's front to gather it
  std::int64_t attached = 0;  // when the clique was hung below its parent, by the number of the tree's elimination
  bool alive = false;

  std::span<const VariableId> frontalVariables() const {
    return {variables.data(), static_cast<std::size_t>(frontals)};
  }
  std::span<const VariableId> separator() const { return std::span(variables).subspan(frontals); }
  int separatorSize() const { return size - frontal_size; }
  int panelStride() const { return padded(size + 1); }
  Panel panelView() const { return {.data = panel, .ld = panelStride(), .rows = size + 1, .columns = frontal_size}; }
  /// The panel without d: [R S]^T. Above the diagonal of R^T anything may stand.
  Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>> factor() const {
    return {panel, size, frontal_size, Eigen::OuterStride<>(panelStride())};
  }
  PackedTriangle updateMatrix() const { return {update_matrix, separatorSize()}; }
  std::size_t panelLength() const { return std::size_t(panelStride()) * frontal_size; }
  std::size_t updateMatrixLength() const { return PackedTriangle::length(separatorSize()); }
};

}  // namespace motorcade
