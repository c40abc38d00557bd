#pragma once

#include <span>
#include <vector>

#include "backend/elimination/elimination_tree.hpp"
#include "backend/elimination/front_sums.hpp"
#include "backend/graph/factor_graph.hpp"

namespace motorcade {

/// Dense work of an elimination, one clique at a time. Gathers the clique's front [H g; g^T c] from the linear models
/// of its factors and from what its children pass on, and factorizes it.
class Front {
 public:
  Front(const FactorGraph& graph, const EliminationTree& tree) : graph_(graph), tree_(tree) {}

  /// Eliminates a clique whose children have been eliminated and have their update matrices. A scalar that no factor
  /// constrains keeps its x. Returns the smallest pivot over its diagonal entry before elimination, at most 1; 0 where
  /// a scalar was singular.
  double eliminate(Clique& clique);
  /// Fills the update matrix of a clique as its elimination did; the rest of the clique stays.
  void makeUpdateMatrix(Clique& clique);
  /// [H g; g^T c], lower triangle, that the newest clique leaves on its separator.
  Eigen::MatrixXd schurComplement() const;

 private:
  void gather(const Clique& clique, double* panel);
  void begin(const Clique& clique, double* panel);
  void addFactor(const Clique& clique, FactorId id);
  void addChild(const Clique& clique, const Clique& child);
  void addRightHandSide(const Clique& clique, const double* g);
  void splitAtFrontals(int frontal_size);
  void subtractEliminated(const Clique& clique);
  void packUpdateMatrix(Clique& clique) const;
  void packContribution(Clique& clique) const;
  void holdSingular(Clique& clique, int column);

  const FactorGraph& graph_;
  const EliminationTree& tree_;
  std::vector<int> offset_;  // per variable: its first scalar in the front at hand
  std::vector<RowSpan> spans_;
  std::vector<double> product_;
  FrontColumns columns_{};  // of the front at hand; its panel is the clique's, or one that is not needed
  std::vector<double, Eigen::aligned_allocator<double>> unneeded_panel_;
  /// [H g; g^T c] on the separator, until it is packed.
  std::vector<double, Eigen::aligned_allocator<double>> update_matrix_;
  int update_size_ = 0, update_stride_ = 0;
};

}  // namespace motorcade
