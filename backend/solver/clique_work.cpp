#include "backend/solver/clique_work.hpp"

#include <algorithm>

namespace motorcade {

void CliqueWork::begin() {
  kind_.resize(tree_.slots(), Kind::kNone);
  change_begin_.resize(tree_.slots());
  dirty_.clear();
  changes_.clear();
  removed_.clear();
}

void CliqueWork::mark(int clique, Kind kind) {
  for (int c = clique; c >= 0 && kind_[c] < kind; c = tree_[c].parent) {
    if (kind_[c] == Kind::kNone) {
      dirty_.push_back(c);
      change_begin_[c] = changes_.size();
      if (kind == Kind::kShift) changes_.resize(changes_.size() + tree_[c].size, 0.0);
    }
    kind_[c] = kind;
  }
}

void CliqueWork::markRemoved(int clique) {
  for (int c = clique; c >= 0 && kind_[c] != Kind::kRemoved; c = tree_[c].parent) {
    kind_[c] = Kind::kRemoved;
    removed_.push_back(c);
  }
}

std::span<double> CliqueWork::markShift(int clique) {
  mark(clique, Kind::kShift);
  return kind_[clique] == Kind::kShift ? changeOf(clique) : std::span<double>();
}

std::span<double> CliqueWork::changeOf(int clique) {
  return {changes_.data() + change_begin_[clique], static_cast<std::size_t>(tree_[clique].size)};
}

void CliqueWork::apply(Eliminator& eliminator) {
  in_order_.clear();
  for (const int c : dirty_) in_order_.emplace_back(tree_.sequence(c), c);
  std::ranges::sort(in_order_);
  for (const auto& [sequence, c] : in_order_) {
    if (kind_[c] == Kind::kRefresh) {
      eliminator.refresh(c);
    } else {
      const int parent = tree_[c].parent;
      const bool passed_on = parent >= 0 && kind_[parent] == Kind::kShift;
      eliminator.shiftRightHandSide(c, changeOf(c), passed_on ? changeOf(parent) : std::span<double>());
    }
  }
}

std::span<const int> CliqueWork::releaseRemoved() {
  for (const int c : removed_) kind_[c] = Kind::kNone;
  return removed_;
}

void CliqueWork::markNew(std::span<const int> cliques) {
  kind_.resize(tree_.slots(), Kind::kNone);
  change_begin_.resize(tree_.slots());
  for (const int c : cliques) kind_[c] = Kind::kNew;
}

}  // namespace motorcade
