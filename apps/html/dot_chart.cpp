#include "apps/html/dot_chart.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "apps/html/chart_frame.hpp"
#include "apps/html/html_page.hpp"

namespace motorcade {
namespace {

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

std::string dotChart(const std::string& x, const std::vector<ChartPart>& series, const std::vector<DotRow>& rows) {
  const DotSheet sheet(rows);
  std::string svg = fmt::format(R"(<svg class="chart" viewBox="0 0 {} {}" role="img">)", coordinate(kWidth),
                                coordinate(sheet.bottom() + kBottom));
  svg += axisOf(sheet, x) + legendOf(series);
  for (std::size_t i = 0; i < rows.size(); ++i) svg += rowOf(sheet, rows[i], i, series);
  return svg + "</svg>";
}

}  // namespace motorcade
