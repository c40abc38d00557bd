#include "apps/html/chart_frame.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "apps/html/html_page.hpp"

namespace motorcade {
namespace {

constexpr double kLetter = 6.3;  // average width of a letter of the legend
constexpr double kTickDistanceAcross = 65, kTickDistanceUp = 40;
constexpr double kWideWidth = 1040, kMapHeightMost = 520, kMapHeightLeast = 160;

std::string tickText(double value, double step) {
  const int decimals = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 6);
  return fmt::format("{:.{}f}", std::abs(value) < 1e-9 * step ? 0.0 : value, decimals);
}

double stepOf(const std::vector<double>& ticks) { return ticks.size() > 1 ? ticks[1] - ticks[0] : 1; }

}  // namespace

std::string coordinate(double value) { return fmt::format("{:.1f}", value); }

/// Creates the frame. A map is as high as its content needs, within bounds, and its ranges grow to equal scales.
ChartFrame::ChartFrame(const ChartAxes& axes, ChartRange range)
    : range_(range), is_map_(axes.equal_scales), is_wide_(axes.wide || is_map_) {
  if (is_wide_) width_ = kWideWidth;
  if (is_map_) {
    const double inner_width = width_ - left_ - right_, across = range_.x_high - range_.x_low,
                 up = range_.y_high - range_.y_low;
    const double inner_height = std::clamp(inner_width * up / across, kMapHeightLeast, kMapHeightMost);
    height_ = inner_height + top_ + bottom_;
    const double per_unit = std::min(inner_width / across, inner_height / up);
    const double more_x = (inner_width / per_unit - across) / 2, more_y = (inner_height / per_unit - up) / 2;
    range_ = {range_.x_low - more_x, range_.x_high + more_x, range_.y_low - more_y, range_.y_high + more_y};
  }
  drawAxes(axes);
}

Eigen::Vector2d ChartFrame::at(double x, double y) const {
  return {left_ + (x - range_.x_low) / (range_.x_high - range_.x_low) * (width_ - left_ - right_),
          height_ - bottom_ - (y - range_.y_low) / (range_.y_high - range_.y_low) * (height_ - top_ - bottom_)};
}

Eigen::Vector2d ChartFrame::within(double x, double y) const {
  return at(x, std::clamp(y, range_.y_low, range_.y_high));
}

void ChartFrame::drawAxes(const ChartAxes& axes) {
  const auto fitting = [](double length, double distance) { return std::max(2, static_cast<int>(length / distance)); };
  const auto x_ticks = ticksBetween(range_.x_low, range_.x_high, fitting(width_ - left_ - right_, kTickDistanceAcross)),
             y_ticks = ticksBetween(range_.y_low, range_.y_high, fitting(height_ - top_ - bottom_, kTickDistanceUp));
  const double bottom = height_ - bottom_, right = width_ - right_;
  for (const double tick : y_ticks) {
    const std::string y = coordinate(at(0, tick).y());
    body_ += fmt::format(R"(<line class="grid" x1="{}" x2="{}" y1="{}" y2="{}"/>)", coordinate(left_),
                         coordinate(right), y, y);
    body_ += fmt::format(R"(<text x="{}" y="{}" text-anchor="end">{}</text>)", coordinate(left_ - 6),
                         coordinate(at(0, tick).y() + 4), tickText(tick, stepOf(y_ticks)));
  }
  for (const double tick : x_ticks) {
    const std::string x = coordinate(at(tick, 0).x());
    if (is_map_)
      body_ += fmt::format(R"(<line class="grid" x1="{}" x2="{}" y1="{}" y2="{}"/>)", x, x, coordinate(top_),
                           coordinate(bottom));
    body_ += fmt::format(R"(<text x="{}" y="{}" text-anchor="middle">{}</text>)", x, coordinate(bottom + 16),
                         tickText(tick, stepOf(x_ticks)));
  }
  body_ += fmt::format(R"(<line class="axis" x1="{}" x2="{}" y1="{}" y2="{}"/>)", coordinate(left_), coordinate(right),
                       coordinate(bottom), coordinate(bottom));
  body_ += fmt::format(R"(<text x="{}" y="{}" text-anchor="end">{}</text>)", coordinate(right), coordinate(bottom + 33),
                       escaped(axes.x));
  body_ += fmt::format(R"(<text x="{}" y="{}" class="ylabel">{}</text>)", coordinate(left_), coordinate(top_ - 10),
                       escaped(axes.y));
}

void ChartFrame::addMark(const Eigen::Vector2d& point, std::string_view color, std::string_view text) {
  const Eigen::Vector2d p = at(point.x(), point.y());
  const bool at_edge = p.x() + 10 + kLetter * static_cast<double>(text.size()) > width_ - right_;
  body_ +=
      fmt::format(R"(<circle cx="{}" cy="{}" r="3.5" style="fill:{}"/>)", coordinate(p.x()), coordinate(p.y()), color);
  body_ += fmt::format(R"(<text class="mark" x="{}" y="{}" text-anchor="{}">{}</text>)",
                       coordinate(p.x() + (at_edge ? -7 : 7)), coordinate(p.y() - 6), at_edge ? "end" : "start",
                       escaped(text));
}

/// Adds the legend to the line of the x axis' label, from the left. Entries that do not fit go to lines below.
void ChartFrame::addLegend(const std::vector<ChartPart>& entries) {
  double x = left_, y = height_ - bottom_ + 33;
  double free_until = width_ - 150;  // the label of the axis is right of it
  for (const ChartPart& entry : entries) {
    if (entry.name.empty()) continue;
    const double length = 18 + kLetter * static_cast<double>(entry.name.size());
    if (x > left_ && x + length > free_until) {
      x = left_;
      y += 17;
      free_until = width_;
      legend_height_ = y + 9 - height_;
    }
    body_ += fmt::format(R"(<rect x="{}" y="{}" width="10" height="10" rx="2" style="fill:{}"/>)", coordinate(x),
                         coordinate(y - 9), entry.color);
    body_ += fmt::format(R"(<text x="{}" y="{}">{}</text>)", coordinate(x + 14), coordinate(y), escaped(entry.name));
    x += length + 12;
  }
}

std::string ChartFrame::svg() const {
  const std::string element =
      fmt::format(R"(<svg class="{}" viewBox="0 0 {} {}" role="img">{}</svg>)", is_wide_ ? "chart across" : "chart",
                  coordinate(width_), coordinate(height_ + legend_height_), body_);
  if (!is_wide_) return element;
  return fmt::format(R"(<div class="wide">{}</div><p class="swipe">Scroll sideways to see all of it.</p>)", element);
}

}  // namespace motorcade
