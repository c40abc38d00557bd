#include "apps/html/svg_chart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "apps/html/chart_frame.hpp"
#include "apps/html/html_page.hpp"

namespace motorcade {
namespace {

/// Most points of a line. More points than a chart has pixels only make the page large.
constexpr std::size_t kMostPoints = 700;

bool isShown(const Eigen::Vector2d& point) { return point.allFinite(); }

void widen(double& low, double& high) {
  if (!(low <= high)) low = 0, high = 1;
  if (high - low < 1e-9) low -= 0.5, high += 0.5;
}

/// Half width of a band for which the chart's range makes room. The first, unsure estimates would leave no room for
/// others.
double roomFor(const ChartLine& line) {
  constexpr double kTimesMedian = 3;
  std::vector<double> half = line.half_width;
  std::erase_if(half, [](double width) { return !std::isfinite(width); });
  if (half.empty()) return 0;
  const auto middle = half.begin() + static_cast<std::ptrdiff_t>(half.size() / 2);
  std::ranges::nth_element(half, middle);
  return kTimesMedian * *middle;
}

ChartRange rangeOf(const ChartAxes& axes, const std::vector<ChartLine>& lines) {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  ChartRange range{kFar, -kFar, kFar, -kFar};
  for (const ChartLine& line : lines) {
    const double most_half = roomFor(line);
    for (std::size_t i = 0; i < line.points.size(); ++i) {
      const Eigen::Vector2d& point = line.points[i];
      if (!isShown(point)) continue;
      const double half = i < line.half_width.size() ? std::min(line.half_width[i], most_half) : 0;
      range.x_low = std::min(range.x_low, point.x());
      range.x_high = std::max(range.x_high, point.x());
      range.y_low = std::min(range.y_low, point.y() - half);
      range.y_high = std::max(range.y_high, point.y() + half);
    }
  }
  if (axes.from_zero && !axes.equal_scales) range.y_low = 0;
  widen(range.x_low, range.x_high);
  widen(range.y_low, range.y_high);
  const double margin = 0.06 * (range.y_high - range.y_low);
  range.y_high += margin;
  if (!axes.from_zero || axes.equal_scales) range.y_low -= margin;
  return range;
}

/// The pieces of a line between its breaks; every n-th point of each, and the last.
std::vector<std::vector<std::size_t>> piecesOf(const ChartLine& line) {
  const std::size_t step = std::max<std::size_t>(1, (line.points.size() + kMostPoints - 1) / kMostPoints);
  std::vector<std::vector<std::size_t>> pieces;
  std::size_t begin = 0;
  while (begin < line.points.size()) {
    if (!isShown(line.points[begin])) {
      ++begin;
      continue;
    }
    std::size_t end = begin;
    while (end < line.points.size() && isShown(line.points[end])) ++end;
    std::vector<std::size_t>& piece = pieces.emplace_back();
    for (std::size_t i = begin; i < end; i += step) piece.push_back(i);
    if (piece.back() + 1 != end) piece.push_back(end - 1);
    begin = end;
  }
  return pieces;
}

/// A piece of one point is a dot.
std::string pathOf(const ChartFrame& frame, const ChartLine& line) {
  std::string path;
  for (const auto& piece : piecesOf(line)) {
    const char* command = "M";
    for (const std::size_t i : piece) {
      const Eigen::Vector2d at = frame.at(line.points[i].x(), line.points[i].y());
      path.append(std::exchange(command, "L")).append(coordinate(at.x())).append(" ").append(coordinate(at.y()));
    }
    if (piece.size() == 1) path.append("h0");
  }
  return path;
}

/// Draws each piece of the band: along its upper edge, and back along the lower one.
std::string bandOf(const ChartFrame& frame, const ChartLine& line) {
  std::string band;
  for (const auto& piece : piecesOf(line)) {
    std::string forth, back;
    for (const std::size_t i : piece) {
      const Eigen::Vector2d& point = line.points[i];
      if (i >= line.half_width.size() || !std::isfinite(line.half_width[i])) continue;
      const Eigen::Vector2d upper = frame.within(point.x(), point.y() + line.half_width[i]),
                            lower = frame.within(point.x(), point.y() - line.half_width[i]);
      forth.append(forth.empty() ? "M" : "L").append(coordinate(upper.x())).append(" ").append(coordinate(upper.y()));
      back.insert(0, fmt::format("L{} {}", coordinate(lower.x()), coordinate(lower.y())));
    }
    if (!forth.empty()) band.append(forth).append(back).append("Z");
  }
  return band;
}

constexpr double kWidth = 560, kRight = 14, kTop = 28, kBottom = 40, kRow = 20, kPerCharacter = 6.6;
constexpr std::size_t kMostCharacters = 28;

/// The sheet of a dot chart. If values are of very different sizes, and all positive, its axis is logarithmic.
class DotSheet {
 public:
  explicit DotSheet(const std::vector<DotRow>& rows) : height_(kTop + kRow * static_cast<double>(rows.size())) {
    constexpr double kVeryDifferent = 20;
    std::size_t longest = 0;
    for (const DotRow& row : rows) {
      longest = std::max(longest, std::min(row.name.size(), kMostCharacters));
      for (const auto& values : row.values)
        for (const double value : values)
          if (std::isfinite(value)) {
            low_ = std::min(low_, value);
            high_ = std::max(high_, value);
          }
    }
    left_ = 12 + kPerCharacter * static_cast<double>(longest);
    logarithmic_ = low_ > 0 && high_ > kVeryDifferent * low_;
    if (!logarithmic_) low_ = 0;
    if (high_ <= low_) high_ = low_ + 1;
  }

  double x(double value) const {
    constexpr double kMargin = 0.03;  // of the width, beside the outermost dots
    const double share =
        logarithmic_ ? std::log(value / low_) / std::log(high_ / low_) : (value - low_) / (high_ - low_);
    return left_ + (kWidth - kRight - left_) * (kMargin + (1 - 2 * kMargin) * share);
  }
  static double y(std::size_t row) { return kTop + kRow * (static_cast<double>(row) + 0.5); }
  double left() const { return left_; }
  double bottom() const { return height_; }

  std::vector<double> ticks() const {
    constexpr int kWanted = 6;
    if (!logarithmic_) return ticksBetween(low_, high_, kWanted);
    std::vector<double> ticks;
    for (double power = std::pow(10, std::floor(std::log10(low_))); power <= high_; power *= 10)
      for (const double digit : {1.0, 2.0, 5.0})
        if (digit * power >= low_ && digit * power <= high_) ticks.push_back(digit * power);
    return ticks;
  }

 private:
  double height_, left_ = 0, low_ = std::numeric_limits<double>::infinity(), high_ = 0;
  bool logarithmic_ = false;
};

std::string axisOf(const DotSheet& sheet, const std::string& label) {
  std::string svg;
  for (const double tick : sheet.ticks())
    svg += fmt::format(R"(<line class="grid" x1="{0}" y1="{1}" x2="{0}" y2="{2}"/>)"
                       R"(<text x="{0}" y="{3}" text-anchor="middle">{4:g}</text>)",
                       coordinate(sheet.x(tick)), coordinate(kTop), coordinate(sheet.bottom()),
                       coordinate(sheet.bottom() + 15), tick == 0 ? 0 : tick);
  return svg + fmt::format(R"(<text x="{}" y="{}" text-anchor="middle">{}</text>)",
                           coordinate((sheet.left() + kWidth) / 2), coordinate(sheet.bottom() + 32), escaped(label));
}

/// The dots of a series in one row; series stand a little above and below each other.
std::string dotsOf(const DotSheet& sheet, const std::vector<double>& values, const std::string& color, double y) {
  std::string svg;
  std::vector<double> shown;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    shown.push_back(value);
    svg += fmt::format(R"(<circle cx="{}" cy="{}" r="3" style="fill:{}" fill-opacity="0.65"/>)",
                       coordinate(sheet.x(value)), coordinate(y), color);
  }
  if (shown.size() < 2) return svg;
  const double mean = std::accumulate(shown.begin(), shown.end(), 0.0) / static_cast<double>(shown.size());
  return svg + fmt::format(R"(<line x1="{0}" y1="{1}" x2="{0}" y2="{2}" style="stroke:{3};stroke-width:2"/>)",
                           coordinate(sheet.x(mean)), coordinate(y - 6), coordinate(y + 6), color);
}

std::string rowOf(const DotSheet& sheet, const DotRow& row, std::size_t place, const std::vector<ChartPart>& series) {
  const double middle = DotSheet::y(place);
  std::string name = row.name;
  if (name.size() > kMostCharacters) name = name.substr(0, kMostCharacters - 2) + "..";
  std::string svg = fmt::format(R"(<text x="{}" y="{}" text-anchor="end">{}</text>)", coordinate(sheet.left() - 8),
                                coordinate(middle + 4), escaped(name));
  const double apart = series.size() > 1 ? (kRow - 8) / static_cast<double>(series.size() - 1) : 0;
  for (std::size_t i = 0; i < std::min(series.size(), row.values.size()); ++i) {
    const double offset = series.size() > 1 ? apart * static_cast<double>(i) - (kRow - 8) / 2 : 0;
    svg += dotsOf(sheet, row.values[i], series[i].color, middle + offset);
  }
  return svg;
}

std::string legendOf(const std::vector<ChartPart>& series) {
  std::string svg;
  double x = 12;
  for (const ChartPart& part : series) {
    if (part.name.empty()) continue;
    svg += fmt::format(R"(<circle cx="{}" cy="12" r="4" style="fill:{}"/><text x="{}" y="16">{}</text>)", coordinate(x),
                       part.color, coordinate(x + 8), escaped(part.name));
    x += 28 + kPerCharacter * static_cast<double>(part.name.size());
  }
  return svg;
}

}  // namespace

const std::string_view kChartStyle = R"css(
:root {
  --strength: 72%;
  --line1: #0b62c4; --line2: #c2410c; --truth: #4b5563; --s1: #2f6fb7; --s2: #69a5dc; --s3: #2a9d8f; --s4: #d9a62e;
  --s5: #b4558a; --s6: #6b5bbf; --s7: #d1663a; --wait: #c3cad2;
}
@media (prefers-color-scheme: dark) {
  :root {
    --line1: #6cb2ff; --line2: #ff9d66; --truth: #b6c0cb; --s1: #4f8fd6; --s2: #8cc3f2; --s3: #4cc0b0; --s4: #e8bf55;
    --s5: #d982b2; --s6: #9a8cec; --s7: #f08d63; --wait: #46505c; --strength: 100%;
  }
}
@media print {
  :root {
    --line1: #0b4ea2; --line2: #b33c0a; --truth: #444444; --s1: #2f6fb7; --s2: #69a5dc; --s3: #2a9d8f; --s4: #d9a62e;
    --s5: #b4558a; --s6: #6b5bbf; --s7: #d1663a; --wait: #c3cad2; --strength: 72%;
  }
}
.chart { width: 100%; font-size: 11.5px; } .chart.across { min-width: 40rem; }
@media print { .chart.across { min-width: 0; } }
.chart text { fill: var(--muted); } .chart .mark { fill: var(--ink); paint-order: stroke; stroke: var(--card);
  stroke-width: 4px; stroke-linejoin: round; }
.chart .grid { stroke: var(--rule); stroke-width: 1; } .chart .axis { stroke: var(--muted); stroke-width: 1; }
.chart .line { fill: none; stroke-width: 1.8; stroke-linejoin: round; stroke-linecap: round; }
.chart .dashed { stroke-dasharray: 5 5; stroke-width: 1.5; } .chart .band { opacity: 0.2; }
figure.plate { --under: var(--card); background: var(--card); border: 1px solid var(--rule); border-radius: 10px;
  padding: 0.8rem; }
)css";

std::string chartFigure(const std::string& svg, const std::string& caption) {
  return "<figure class=\"plate\">" + svg + "<figcaption>" + escaped(caption) + "</figcaption></figure>\n";
}

Eigen::Vector2d lineBreak() { return Eigen::Vector2d::Constant(std::numeric_limits<double>::quiet_NaN()); }

std::vector<double> ticksBetween(double low, double high, int wanted) {
  const double rough = (high - low) / std::max(wanted, 1);
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double share = rough / power;
  const double step = power * (share <= 1 ? 1 : share <= 2 ? 2 : share <= 5 ? 5 : 10);
  std::vector<double> ticks;
  for (double tick = std::ceil(low / step - 1e-9) * step; tick <= high + 1e-9 * step; tick += step)
    ticks.push_back(tick);
  return ticks;
}

std::string lineChart(const ChartAxes& axes, const std::vector<ChartLine>& lines) {
  ChartFrame frame(axes, rangeOf(axes, lines));
  for (const ChartLine& line : lines)
    if (!line.half_width.empty())
      frame.add(fmt::format(R"(<path class="band" style="fill:{}" d="{}"/>)", line.color, bandOf(frame, line)));
  std::vector<ChartPart> legend;
  for (const ChartLine& line : lines) {
    frame.add(fmt::format(R"(<path class="{}" style="stroke:{}" d="{}"/>)", line.dashed ? "line dashed" : "line",
                          line.color, pathOf(frame, line)));
    legend.push_back({line.name, line.color});
  }
  for (const ChartLine& line : lines)
    if (!line.mark.empty() && !line.points.empty() && isShown(line.points.back()))
      frame.addMark(line.points.back(), line.color, line.mark);
  frame.addLegend(legend);
  return frame.svg();
}

std::string barChart(const ChartAxes& axes, const std::vector<ChartPart>& parts, const std::vector<ChartBar>& bars) {
  double highest = 0, left = 0, right = 1;
  if (!bars.empty()) left = bars.front().from, right = bars.back().to;
  for (const ChartBar& bar : bars) {
    double sum = 0;
    for (const double part : bar.parts) sum += part;
    highest = std::max(highest, sum);
  }
  ChartFrame frame(axes, {left, right, 0, highest > 0 ? 1.06 * highest : 1});
  for (std::size_t part = 0; part < parts.size(); ++part) {
    std::string path;
    for (const ChartBar& bar : bars) {
      double below = 0;
      for (std::size_t k = 0; k < part; ++k) below += bar.parts[k];
      if (bar.parts[part] <= 0) continue;
      const Eigen::Vector2d upper = frame.at(bar.from, below + bar.parts[part]), lower = frame.at(bar.to, below);
      path += fmt::format("M{} {}H{}V{}H{}Z", coordinate(upper.x()), coordinate(upper.y()), coordinate(lower.x()),
                          coordinate(lower.y()), coordinate(upper.x()));
    }
    frame.add(fmt::format(R"(<path style="fill:{}" d="{}"/>)", parts[part].color, path));
  }
  frame.addLegend(parts);
  return frame.svg();
}

std::string dotChart(const std::string& x, const std::vector<ChartPart>& series, const std::vector<DotRow>& rows) {
  const DotSheet sheet(rows);
  std::string svg = fmt::format(R"(<svg class="chart" viewBox="0 0 {} {}" role="img">)", coordinate(kWidth),
                                coordinate(sheet.bottom() + kBottom));
  svg += axisOf(sheet, x) + legendOf(series);
  for (std::size_t i = 0; i < rows.size(); ++i) svg += rowOf(sheet, rows[i], i, series);
  return svg + "</svg>";
}

}  // namespace motorcade
