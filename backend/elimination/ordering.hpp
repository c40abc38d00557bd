#pragma once

#include <span>
#include <vector>

namespace motorcade {

/// Elimination order with little fill for the columns of a sparse matrix, by constrained column approximate minimum
/// degree (CCOLAMD). Add rows, then order. Keeps its memory for the next time.
class Ordering {
 public:
  void begin(int columns);
  /// Adds a row with entries in these columns.
  void addRow(std::span<const int> columns);
  /// Orders the columns; those of a higher `group` come later. The result lasts until the next `begin`.
  std::span<const int> order(std::span<const int> group);

 private:
  int columns_ = 0, rows_ = 0;
  std::vector<int> entry_row_, entry_column_;
  std::vector<int> start_, next_, row_numbers_, members_;
};

}  // namespace motorcade
