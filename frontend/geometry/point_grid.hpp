#pragma once

#include <algorithm>
#include <vector>

#include <Eigen/Core>

namespace motorcade {

/// Finds points of an image by their position. Points outside the image count as points on its border.
class PointGrid {
 public:
  static constexpr int kCell_px = 32;

  /// `position_px(item)` returns the position of an item.
  template <class Items, class Position>
  PointGrid(const Items& items, int width, int height, const Position& position_px)
      : columns_(width / kCell_px + 1),
        rows_(height / kCell_px + 1),
        ends_(columns_ * rows_ + 1, 0),
        points_(items.size()) {
    for (const auto& item : items) ++ends_[cellOf(position_px(item)) + 1];
    for (std::size_t i = 1; i < ends_.size(); ++i) ends_[i] += ends_[i - 1];
    std::vector<int> next(ends_.begin(), ends_.end() - 1);
    int number = 0;
    for (const auto& item : items) points_[next[cellOf(position_px(item))]++] = number++;
  }

  /// Indices of all points, cell by cell, so that points near each other follow each other.
  const std::vector<int>& byPlace() const { return points_; }

  /// Calls f(first, end) for ranges of `byPlace` that hold all points in a rectangle, and some around it, each once.
  template <class Function>
  void forEachRangeNear(const Eigen::Vector2f& min_px, const Eigen::Vector2f& max_px, const Function& f) const {
    const int first = column(min_px.x()), last = column(max_px.x());
    for (int y = row(min_px.y()); y <= row(max_px.y()); ++y) {
      const int line = y * columns_;
      f(ends_[line + first], ends_[line + last + 1]);
    }
  }
  /// Calls f(index) for all points in a rectangle, and for some around it, each once.
  template <class Function>
  void forEachNear(const Eigen::Vector2f& min_px, const Eigen::Vector2f& max_px, const Function& f) const {
    forEachRangeNear(min_px, max_px, [&](int first, int end) {
      for (int i = first; i < end; ++i) f(points_[i]);
    });
  }
  /// Half the side of a square that holds all points, around any point of the image.
  float extent_px() const { return kCell_px * static_cast<float>(std::max(columns_, rows_)); }

 private:
  int column(float u_px) const { return std::clamp(static_cast<int>(u_px / kCell_px), 0, columns_ - 1); }
  int row(float v_px) const { return std::clamp(static_cast<int>(v_px / kCell_px), 0, rows_ - 1); }
  int cellOf(const Eigen::Vector2f& p) const { return row(p.y()) * columns_ + column(p.x()); }

  int columns_, rows_;
  std::vector<int> ends_;    // cell c holds points_[ends_[c]] to points_[ends_[c + 1] - 1]
  std::vector<int> points_;  // indices of the points, cell by cell, in their order
};

}  // namespace motorcade
