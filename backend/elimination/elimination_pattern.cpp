#include "backend/elimination/elimination_pattern.hpp"

#include <algorithm>

namespace motorcade {
namespace {

/// Limits up to which a column joins its parent's clique although that adds zeros: a clique with few frontals, or few
/// zeros. Each front passes a matrix on, which costs as much as the elimination of a pose or two.
constexpr int kFewFrontals = 18;    // scalars: three poses
constexpr double kZeroShare = 0.1;  // of the clique's scalars

}  // namespace

void EliminationPattern::begin(int count, int boundary) {
  count_ = count;
  total_ = count + boundary;
  first_of_term_.clear();
  term_entries_.clear();
  term_begin_.assign(1, 0);
  terms_next_.clear();
  terms_head_.assign(count, -1);
}

bool EliminationPattern::addTerm(std::span<const int> positions) {
  const int first = *std::ranges::min_element(positions);
  if (first >= count_) return false;
  terms_next_.push_back(terms_head_[first]);
  terms_head_[first] = static_cast<int>(first_of_term_.size());
  first_of_term_.push_back(first);
  term_entries_.insert(term_entries_.end(), positions.begin(), positions.end());
  term_begin_.push_back(static_cast<int>(term_entries_.size()));
  return true;
}

void EliminationPattern::analyze(std::span<const int> scalars) {
  mergeColumns();
  formGroups(scalars);
}

/// Finds the column structures: each is the union of its terms and of what the columns below it leave over.
void EliminationPattern::mergeColumns() {
  children_head_.assign(count_, -1);
  children_next_.assign(count_, -1);
  parent_.assign(count_, -1);
  stamp_.assign(total_, -1);
  column_begin_.assign(1, 0);
  column_entries_.clear();
  for (int j = 0; j < count_; ++j) {
    const auto begin = static_cast<std::ptrdiff_t>(column_entries_.size());
    stamp_[j] = j;
    const auto take = [&](int position) {
      if (stamp_[position] == j) return;
      stamp_[position] = j;
      column_entries_.push_back(position);
    };
    for (int t = terms_head_[j]; t >= 0; t = terms_next_[t])
      for (int e = term_begin_[t]; e < term_begin_[t + 1]; ++e) take(term_entries_[e]);
    for (int child = children_head_[j]; child >= 0; child = children_next_[child])
      for (int e = column_begin_[child]; e < column_begin_[child + 1]; ++e) take(column_entries_[e]);
    std::sort(column_entries_.begin() + begin, column_entries_.end());
    column_begin_.push_back(static_cast<int>(column_entries_.size()));
    if (static_cast<std::size_t>(begin) == column_entries_.size()) continue;
    const int parent = column_entries_[begin];
    if (parent >= count_) continue;
    parent_[j] = parent;
    children_next_[j] = children_head_[parent];
    children_head_[parent] = j;
  }
}

/// Forms supernodes: a column whose separator is (nearly) all of its parent's clique joins that clique.
void EliminationPattern::formGroups(std::span<const int> scalars) {
  groups_.clear();
  group_scalars_.clear();
  frontal_scalars_.clear();
  last_in_group_.clear();
  group_of_.assign(count_, -1);
  group_next_.assign(count_, -1);  // from a frontal to the one eliminated after it
  for (int j = count_ - 1; j >= 0; --j) {
    int size = 0;  // scalars of the separator
    for (int e = column_begin_[j]; e < column_begin_[j + 1]; ++e) size += scalars[column_entries_[e]];
    const int own = scalars[j];
    const int above = parent_[j] < 0 ? -1 : group_of_[parent_[j]];
    if (above >= 0) {
      const int all = group_scalars_[above], zeros = all - size;
      if (zeros <= kZeroShare * all || frontal_scalars_[above] + own <= kFewFrontals) {
        group_of_[j] = above;
        group_next_[j] = last_in_group_[above];
        last_in_group_[above] = j;
        group_scalars_[above] += own;
        frontal_scalars_[above] += own;
        ++groups_[above].frontals;
        continue;
      }
    }
    group_of_[j] = static_cast<int>(groups_.size());
    last_in_group_.push_back(j);
    group_scalars_.push_back(own + size);
    frontal_scalars_.push_back(own);
    // `begin` holds the column that states the separator until the positions are written.
    groups_.push_back({.begin = j, .size = 0, .frontals = 1, .parent = above});
  }
  positions_.clear();
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    Group& group = groups_[g];
    const int top = group.begin;
    group.begin = static_cast<int>(positions_.size());
    for (int j = last_in_group_[g]; j >= 0; j = group_next_[j]) positions_.push_back(j);
    positions_.insert(positions_.end(), column_entries_.begin() + column_begin_[top],
                      column_entries_.begin() + column_begin_[top + 1]);
    group.size = static_cast<int>(positions_.size()) - group.begin;
  }
}

}  // namespace motorcade
