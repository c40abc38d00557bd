#pragma once

#include <string>
#include <vector>

#include "apps/html/svg_chart.hpp"

namespace motorcade {

/// A row of a chart of dots: values of something with a name, by series.
struct DotRow {
  std::string name{};
  std::vector<std::vector<double>> values{};  // one list per series; what is not finite is left out
};

/// Where values lie, one row above the other, on a common axis, from zero or, where values are of very
/// different sizes, logarithmic; a stroke at each series' mean. The legend
/// has the series with names.
std::string dotChart(const std::string& x, const std::vector<ChartPart>& series, const std::vector<DotRow>& rows);

}  // namespace motorcade
