#include "backend/elimination/update_matrices.hpp"

#include <algorithm>

namespace motorcade {
namespace {

/// Most cliques without an update matrix in a row: making the uppermost one's matrix takes those of all below.
constexpr int kMostInARow = 16;

}  // namespace

void UpdateMatrices::noteAttached(int clique) {
  tree_[clique].attached = eliminations_;
  if (kept_eliminations_ > 0) attached_.push_back({eliminations_, clique});
}

void UpdateMatrices::giveBackOld() {
  if (memory_.heldBytes() <= kept_bytes_) return;
  for (; !attached_.empty() && eliminations_ - attached_.front().when > kept_eliminations_; attached_.pop_front()) {
    const auto [when, id] = attached_.front();
    Clique& clique = tree_[id];
    if (clique.alive && clique.attached == when && clique.update_matrix && mayGiveBack(id)) giveBack(clique);
  }
}

bool UpdateMatrices::mayGiveBack(int clique) const {
  int in_a_row = 1 + depthWithout(clique);
  for (int above = tree_[clique].parent; above >= 0 && !tree_[above].update_matrix; above = tree_[above].parent)
    ++in_a_row;
  return in_a_row <= kMostInARow;
}

/// Length of the longest row of cliques without an update matrix below a clique.
int UpdateMatrices::depthWithout(int clique) const {
  int depth = 0;
  for (int child = tree_[clique].first_child; child >= 0; child = tree_[child].next_sibling)
    if (!tree_[child].update_matrix) depth = std::max(depth, 1 + depthWithout(child));
  return depth;
}

void UpdateMatrices::takeAgain(Clique& clique) {
  if (clique.update_matrix) return;
  take(clique);
  clique.made_again = true;
}

void UpdateMatrices::giveBack(Clique& clique) {
  memory_.give(clique.update_matrix);
  clique.update_matrix = nullptr;
}

void UpdateMatrices::makeBelow(const Clique& clique) {
  for (int id = clique.first_child; id >= 0; id = tree_[id].next_sibling) {
    Clique& child = tree_[id];
    if (child.update_matrix) continue;
    makeBelow(child);
    takeAgain(child);
    front_.makeUpdateMatrix(child);
    giveBackMadeAgainBelow(child);
  }
}

void UpdateMatrices::giveBackMadeAgainBelow(const Clique& clique) {
  for (int id = clique.first_child; id >= 0; id = tree_[id].next_sibling) {
    Clique& child = tree_[id];
    if (child.made_again && child.attached != eliminations_) giveBack(child);
    child.made_again = false;
  }
}

}  // namespace motorcade
