#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "apps/html/svg_chart.hpp"

namespace motorcade {

/// The ranges that a chart shows.
struct ChartRange {
  double x_low = 0, x_high = 1, y_low = 0, y_high = 1;
};

/// Layout of a chart on its sheet, and the parts that all charts have: axes, grid, ticks, legend.
class ChartFrame {
 public:
  ChartFrame(const ChartAxes& axes, ChartRange range);

  /// Converts the chart's units to the sheet's.
  Eigen::Vector2d at(double x, double y) const;
  /// Converts likewise, but moves a point above or below the range to its edge.
  Eigen::Vector2d within(double x, double y) const;
  /// An element between axes and legend.
  void add(std::string_view svg) { body_ += svg; }
  /// A dot at a point, and a word beside it that stays within the frame.
  void addMark(const Eigen::Vector2d& point, std::string_view color, std::string_view text);
  /// Call it last.
  void addLegend(const std::vector<ChartPart>& entries);
  /// The whole element.
  std::string svg() const;

 private:
  void drawAxes(const ChartAxes& axes);

  ChartRange range_;
  bool is_map_, is_wide_;
  double width_ = 560, height_ = 250, left_ = 48, right_ = 12, top_ = 26, bottom_ = 42;
  double legend_height_ = 0;  // of the lines of the legend below the first
  std::string body_;
};

/// Formats a number for SVG, with one digit after the point.
std::string coordinate(double value);

}  // namespace motorcade
