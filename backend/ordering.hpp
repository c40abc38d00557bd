#pragma once

#include <span>
#include <vector>

namespace motorcade {

/// An elimination order with little fill for the columns of a sparse matrix whose rows hold the column numbers `rows[i]`: constrained
/// column approximate minimum degree (CCOLAMD). Columns of a higher `group` come later. The result lists columns in order.
std::vector<int> eliminationOrder(int columns, std::span<const std::vector<int>> rows, std::span<const int> group);

}  // namespace motorcade
