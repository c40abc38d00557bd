#pragma once

#include <vector>

#include <Eigen/Core>

namespace motorcade {

/// One-to-one assignment of rows to columns with the least total cost: returns each row's column, or -1. A row that
/// stays alone costs `forbidden`, so a pair is made only where it costs less; a cost that is not a number forbids it.
/// Costs may be negative. Takes O(n^2 (n + m)) at worst for n rows and m columns.
std::vector<int> assignMinCost(const Eigen::MatrixXd& cost, double forbidden);

}  // namespace motorcade
