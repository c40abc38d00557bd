#include "core/assignment.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace motorcade {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The Hungarian method by shortest augmenting paths (Jonker and Volgenant, Computing 38, 1987). Rows enter one at a
/// time, each by the cheapest path of reassignments; the dual prices keep all reduced costs non-negative.
class AugmentingPaths {
 public:
  AugmentingPaths(const Eigen::MatrixXd& cost, double forbidden)
      : cost_(cost),
        forbidden_(forbidden),
        columns_(static_cast<int>(cost.cols() + cost.rows())),
        row_price_(cost.rows(), 0.0),
        column_price_(columns_, 0.0),
        row_of_(columns_, -1) {}

  std::vector<int> solve() {
    for (int row = 0; row < cost_.rows(); ++row) enter(row);
    std::vector<int> column_of(cost_.rows(), -1);
    for (int column = 0; column < cost_.cols(); ++column) {
      const int row = row_of_[column];
      if (row >= 0) column_of[row] = column;
    }
    return column_of;
  }

 private:
  /// Cost of a pair. Each row also has a column of its own beyond the real ones, where it stays alone.
  double costOf(int row, int column) const {
    if (column >= cost_.cols()) return column - cost_.cols() == row ? forbidden_ : kInfinity;
    const double value = cost_(row, column);
    return value < forbidden_ ? value : kInfinity;
  }

  void enter(int new_row) {
    std::vector<double> distance(columns_, kInfinity);
    std::vector<int> came_from(columns_, -1);  // the column before on the path; -1 is the new row itself
    std::vector<bool> settled(columns_, false);
    int row = new_row, column = -1;
    double reached = 0;
    do {
      relax(row, column, reached, settled, distance, came_from);
      column = nearest(distance, settled);
      assert(column >= 0);  // the row's own column is always within reach
      settled[column] = true;
      reached = distance[column];
      row = row_of_[column];
    } while (row >= 0);
    updatePrices(new_row, reached, settled, distance);
    for (; column >= 0; column = came_from[column]) {
      const int before = came_from[column];
      row_of_[column] = before < 0 ? new_row : row_of_[before];
    }
  }

  void relax(int row, int column, double reached, const std::vector<bool>& settled, std::vector<double>& distance,
             std::vector<int>& came_from) const {
    for (int next = 0; next < columns_; ++next) {
      if (settled[next]) continue;
      const double through = reached + costOf(row, next) - row_price_[row] - column_price_[next];
      if (through < distance[next]) {
        distance[next] = through;
        came_from[next] = column;
      }
    }
  }

  int nearest(const std::vector<double>& distance, const std::vector<bool>& settled) const {
    int best = -1;
    for (int column = 0; column < columns_; ++column) {
      if (!settled[column] && distance[column] < kInfinity && (best < 0 || distance[column] < distance[best]))
        best = column;
    }
    return best;
  }

  void updatePrices(int new_row, double reached, const std::vector<bool>& settled,
                    const std::vector<double>& distance) {
    row_price_[new_row] += reached;
    for (std::size_t j = 0; j < settled.size(); ++j) {
      if (!settled[j]) continue;
      column_price_[j] -= reached - distance[j];
      if (row_of_[j] >= 0) row_price_[row_of_[j]] += reached - distance[j];
    }
  }

  const Eigen::MatrixXd& cost_;
  double forbidden_;
  int columns_;
  std::vector<double> row_price_, column_price_;
  std::vector<int> row_of_;
};

}  // namespace

std::vector<int> assignMinCost(const Eigen::MatrixXd& cost, double forbidden) {
  assert(std::isfinite(forbidden));
  return AugmentingPaths(cost, forbidden).solve();
}

}  // namespace motorcade
