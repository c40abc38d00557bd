#pragma once

#include <vector>

#include <Eigen/Core>

namespace motorcade {

/// One-to-one assignment of rows to columns with the least total cost. A pair whose cost is `forbidden` or more (or not
/// a number) is never made; a row that stays alone costs `forbidden`, so that a pair is made where it costs less. Gives
/// each row's column, or -1. Costs may be negative. Takes O(n^2 (n + m)) at worst for n rows and m columns.
std::vector<int> assignMinCost(const Eigen::MatrixXd& cost, double forbidden);

}  // namespace motorcade
