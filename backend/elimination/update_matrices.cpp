/// The part of EliminationTree that gives old update matrices back. They are most of the tree's memory, and needed only
/// where the parent is eliminated anew without the clique: near the root all the time, farther down hardly ever.

#include <algorithm>

#include "backend/elimination/elimination_tree.hpp"

namespace motorcade {
namespace {

/// Cliques in a row above each other without an update matrix: to make that of the uppermost takes those of the others.
constexpr int kMostInARow = 16;

}  // namespace

void EliminationTree::noteAttached(int clique) {
  cliques_[clique].attached = eliminations_;
  if (kept_eliminations_ > 0) attached_.push_back({eliminations_, clique});
}

void EliminationTree::giveBackOldUpdateMatrices() {
  for (; !attached_.empty() && eliminations_ - attached_.front().when > kept_eliminations_; attached_.pop_front()) {
    const auto [when, id] = attached_.front();
    Clique& clique = cliques_[id];
    if (clique.alive && clique.attached == when && clique.update_matrix && mayGiveBack(id))
      giveBackUpdateMatrix(clique);
  }
}

bool EliminationTree::mayGiveBack(int clique) const {
  int in_a_row = 1 + depthWithout(clique);
  for (int above = cliques_[clique].parent; above >= 0 && !cliques_[above].update_matrix;
       above = cliques_[above].parent)
    ++in_a_row;
  return in_a_row <= kMostInARow;
}

/// Of the cliques without an update matrix that hang below a clique in a row.
int EliminationTree::depthWithout(int clique) const {
  int depth = 0;
  for (int child = cliques_[clique].first_child; child >= 0; child = cliques_[child].next_sibling)
    if (!cliques_[child].update_matrix) depth = std::max(depth, 1 + depthWithout(child));
  return depth;
}

/// Memory for it, where the clique has none.
void EliminationTree::takeUpdateMatrix(Clique& clique) {
  if (clique.update_matrix) return;
  clique.update_matrix = update_matrices_.take(clique.updateMatrixLength());
  clique.made_again = true;
}

void EliminationTree::giveBackUpdateMatrix(Clique& clique) {
  update_matrices_.give(clique.update_matrix);
  clique.update_matrix = nullptr;
}

void EliminationTree::makeUpdateMatricesBelow(const Clique& clique) {
  for (int id = clique.first_child; id >= 0; id = cliques_[id].next_sibling) {
    Clique& child = cliques_[id];
    if (child.update_matrix) continue;
    makeUpdateMatricesBelow(child);
    takeUpdateMatrix(child);
    front_.makeUpdateMatrix(child, cliques_);
    giveBackThoseMadeAgainBelow(child);
  }
}

/// Those of cliques that were attached just now are near the root, and will be gathered again.
void EliminationTree::giveBackThoseMadeAgainBelow(const Clique& clique) {
  for (int id = clique.first_child; id >= 0; id = cliques_[id].next_sibling) {
    Clique& child = cliques_[id];
    if (child.made_again && child.attached != eliminations_) giveBackUpdateMatrix(child);
    child.made_again = false;
  }
}

}  // namespace motorcade
