#include "backend/ordering.hpp"

#include <algorithm>
#include <numeric>
#include <stdexcept>

#include <ccolamd.h>

namespace motorcade {

std::vector<int> eliminationOrder(int columns, std::span<const std::vector<int>> rows, std::span<const int> group) {
  if (columns <= 1) return std::vector<int>(static_cast<std::size_t>(columns), 0);  // CCOLAMD overruns where a group is not below `columns`
  // CCOLAMD wants compressed columns of row numbers.
  std::vector<int> start(static_cast<std::size_t>(columns) + 1, 0);
  for (const auto& row : rows)
    for (const int column : row) ++start[static_cast<std::size_t>(column) + 1];
  std::partial_sum(start.begin(), start.end(), start.begin());
  const int entries = start.back();
  const int row_count = static_cast<int>(rows.size());
  std::vector<int> row_numbers(ccolamd_recommended(entries, row_count, columns));
  std::vector<int> next(start.begin(), start.end() - 1);
  for (int r = 0; r < row_count; ++r)
    for (const int column : rows[static_cast<std::size_t>(r)])
      row_numbers[static_cast<std::size_t>(next[static_cast<std::size_t>(column)]++)] = r;

  std::vector<int> members(group.begin(), group.end());
  double knobs[CCOLAMD_KNOBS];
  ccolamd_set_defaults(knobs);
  knobs[CCOLAMD_DENSE_ROW] = -1;  // every column matters, however many rows it meets
  knobs[CCOLAMD_DENSE_COL] = -1;
  int stats[CCOLAMD_STATS];
  if (!ccolamd(row_count, columns, static_cast<int>(row_numbers.size()), row_numbers.data(), start.data(), knobs, stats, members.data()))
    throw std::logic_error("CCOLAMD rejected a matrix pattern");
  start.pop_back();
  return start;
}

}  // namespace motorcade
