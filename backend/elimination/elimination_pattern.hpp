#pragma once

#include <span>
#include <vector>

#include "backend/graph/variable.hpp"

namespace motorcade {

/// Symbolic part of an elimination: which variables each clique of the result holds. Positions count the variables in
/// their elimination order, then the boundary.
class EliminationPattern {
 public:
  struct Group {
    int begin = 0, size = 0;  // in `positions()`, ascending: frontals first
    int frontals = 0;
    int parent = -1;  // group
  };

  /// Begins a pattern of `count` eliminated positions, which `boundary` positions follow.
  void begin(int count, int boundary);
  /// Adds a term over these positions. Returns false, and adds none, when all of them lie in the boundary. Terms are
  /// numbered as they come.
  bool addTerm(std::span<const int> positions);
  /// Finds the groups; `scalars` are the sizes of the variables at each position, boundary included.
  void analyze(std::span<const int> scalars);

  const std::vector<Group>& groups() const { return groups_; }  // parents before children
  std::span<const int> positions(const Group& group) const {
    return {positions_.data() + group.begin, static_cast<std::size_t>(group.size)};
  }
  int groupOf(int position) const { return group_of_[position]; }
  int groupOfTerm(int term) const { return groupOf(first_of_term_[term]); }

 private:
  void mergeColumns();
  void formGroups(std::span<const int> scalars);

  int count_ = 0, total_ = 0;
  std::vector<int> first_of_term_, term_entries_, term_begin_;
  std::vector<int> terms_head_, terms_next_;        // per column: terms whose first position it is
  std::vector<int> children_head_, children_next_;  // per column: columns whose parent it is
  std::vector<int> column_begin_, column_entries_, parent_, stamp_;
  std::vector<Group> groups_;
  std::vector<int> group_of_, group_scalars_, frontal_scalars_, group_next_, last_in_group_, positions_;
};

}  // namespace motorcade
