#pragma once

#include <string>
#include <vector>

#include "apps/html/svg_chart.hpp"

namespace motorcade {

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
