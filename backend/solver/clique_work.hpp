#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "backend/elimination/eliminator.hpp"

namespace motorcade {

/// Work of a solver's step on each clique. A change of a clique reaches all cliques above it, up to the root. A clique
/// with more than one kind of work gets the most thorough.
class CliqueWork {
 public:
  enum class Kind : char {
    kNone,
    kShift,    // gets a new right-hand side
    kRefresh,  // is eliminated anew where it stands
    kRemoved,  // leaves the tree, its variables are eliminated in a new order
    kNew,      // was eliminated in this step
  };

  explicit CliqueWork(const EliminationTree& tree) : tree_(tree) {}

  /// Begins a step, in which no clique has work yet.
  void begin();
  void markRemoved(int clique);
  void markRefresh(int clique) { mark(clique, Kind::kRefresh); }
  /// Marks a clique for a new right-hand side. Returns the change, in the rows of its front, to add to before the next
  /// mark; empty when the clique is eliminated anew.
  std::span<double> markShift(int clique);

  /// Shifts and refreshes the cliques so marked, children before parents.
  void apply(Eliminator& eliminator);
  /// Releases the marked cliques, which the tree can remove now; they have no more work.
  std::span<const int> releaseRemoved();
  void markNew(std::span<const int> cliques);
  /// Notes that the clique was solved.
  void finish(int clique) { kind_[clique] = Kind::kNone; }

  bool has(int clique) const { return kind_[clique] != Kind::kNone; }
  /// True when the clique is eliminated anew in any case.
  bool isEliminated(int clique) const { return kind_[clique] >= Kind::kRefresh; }
  std::span<const int> removed() const { return removed_; }

 private:
  void mark(int clique, Kind kind);
  std::span<double> changeOf(int clique);

  const EliminationTree& tree_;
  std::vector<Kind> kind_;                              // per clique
  std::vector<int> dirty_;                              // cliques to shift or refresh
  std::vector<std::pair<std::int64_t, int>> in_order_;  // the same by their sequence; scratch
  std::vector<int> removed_;
  std::vector<double> changes_;            // of right-hand sides
  std::vector<std::size_t> change_begin_;  // per clique: where its change lies in `changes_`
};

}  // namespace motorcade
