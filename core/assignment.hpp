#pragma once

#include <vector>

#include <Eigen/Core>

namespace motorcade {

/// One-to-one assignment of rows to columns with the least total cost. A pair whose cost is `forbidden` or more (or not
/// a number) is never made; a row that stays alone costs `forbidden`, so that as many pairs are made as pay off. Gives
/// each row's column, or -1. Costs may be negative. Takes O(n^2 m) for n rows and m columns, n + m in the worst case of
/// many forbidden pairs.
std::vector<int> assignMinCost(const Eigen::MatrixXd& cost, double forbidden);

}  // namespace motorcade
