#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

/// Charts as SVG inside of a page: they follow its colors, scale with it and print.
namespace motorcade {

/// Style of a page with charts, added after its base style. Colors are var(--line1 | --line2), var(--s1) to var(--s7),
/// var(--truth) and var(--wait), beside those of the page. var(--strength) is the share of a color made for dark ground
/// that is used on the page's own ground.
extern const std::string_view kChartStyle;

/// A line of a chart. Where a point is not finite, the line is broken.
struct ChartLine {
  std::string name;   // in the legend; none when empty
  std::string color;  // CSS
  std::vector<Eigen::Vector2d> points{};
  std::vector<double> half_width{};  // of a band around the line, one per point; none when empty
  bool dashed = false;
  std::string mark{};  // beside a dot at the last point; none when empty
};

struct ChartAxes {
  std::string x, y;           // labels, with their units
  bool from_zero = true;      // the y axis begins at 0
  bool equal_scales = false;  // as on a map, with a grid in both directions
  bool wide = false;          // over the width of a page; maps always are
};

/// Lines over common axes, with a legend where lines have names.
std::string lineChart(const ChartAxes& axes, const std::vector<ChartLine>& lines);

/// A bar of several parts, from `from` to `to` on the x axis.
struct ChartBar {
  double from = 0, to = 0;
  std::vector<double> parts;  // one per part's name
};

struct ChartPart {
  std::string name;   // in the legend; none when empty
  std::string color;  // CSS
};

/// Bars whose parts stand on one another.
std::string barChart(const ChartAxes& axes, const std::vector<ChartPart>& parts, const std::vector<ChartBar>& bars);

/// A chart with a caption.
std::string chartFigure(const std::string& svg, const std::string& caption);

/// A point at which a line is broken.
Eigen::Vector2d lineBreak();

/// Round numbers from `low` to `high` for a scale, about `wanted` of them.
std::vector<double> ticksBetween(double low, double high, int wanted);

/// A row of a dot chart: a name and its values by series.
struct DotRow {
  std::string name{};
  std::vector<std::vector<double>> values{};  // one list per series; what is not finite is left out
};

/// Draws the values of each row as dots on a common axis, one row above the other. The axis starts at zero, or is
/// logarithmic where values are of very different sizes. A stroke marks each series' mean. The legend has the series
/// with names.
std::string dotChart(const std::string& x, const std::vector<ChartPart>& series, const std::vector<DotRow>& rows);

}  // namespace motorcade
