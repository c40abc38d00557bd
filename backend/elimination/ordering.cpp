#include "backend/elimination/ordering.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

#include <ccolamd.h>

namespace motorcade {
void Ordering::begin(int columns) {
  columns_ = columns;
  rows_ = 0;
  entry_row_.clear();
  entry_column_.clear();
}

void Ordering::addRow(std::span<const int> columns) {
  for (const int column : columns) {
    entry_row_.push_back(rows_);
    entry_column_.push_back(column);
  }
  ++rows_;
}

std::span<const int> Ordering::order(std::span<const int> group) {
  assert(static_cast<int>(group.size()) == columns_);
  if (columns_ <= 1) {  // CCOLAMD overruns where a group is not below the number of columns
    start_.assign(columns_, 0);
    return start_;
  }
  // CCOLAMD wants compressed columns of row numbers, and at least one row in each column.
  for (int column = 0; column < columns_; ++column) addRow({&column, 1});
  start_.assign(columns_ + 1, 0);
  for (const int column : entry_column_) ++start_[column + 1];
  std::partial_sum(start_.begin(), start_.end(), start_.begin());
  row_numbers_.resize(ccolamd_recommended(start_.back(), rows_, columns_));
  next_.assign(start_.begin(), start_.end() - 1);
  for (std::size_t e = 0; e < entry_row_.size(); ++e) row_numbers_[next_[entry_column_[e]]++] = entry_row_[e];

  members_.assign(group.begin(), group.end());
  double knobs[CCOLAMD_KNOBS];
  ccolamd_set_defaults(knobs);
  knobs[CCOLAMD_DENSE_ROW] = -1;  // every column matters, however many rows it meets
  knobs[CCOLAMD_DENSE_COL] = -1;
  int stats[CCOLAMD_STATS];
  if (!ccolamd(rows_, columns_, static_cast<int>(row_numbers_.size()), row_numbers_.data(), start_.data(), knobs, stats,
               members_.data())) {
    // Any order that keeps the groups is right where CCOLAMD fails, if with more fill.
    std::iota(start_.begin(), start_.end(), 0);
    std::ranges::stable_sort(start_.begin(), start_.end() - 1, {}, [&](int column) { return group[column]; });
  }
  return {start_.data(), static_cast<std::size_t>(columns_)};
}

}  // namespace motorcade
