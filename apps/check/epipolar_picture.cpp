#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "apps/canvas/canvas.hpp"
#include "apps/check/check_page.hpp"
#include "apps/watch/pair_geometry.hpp"

namespace motorcade {
namespace {

using Eigen::Vector2d;

constexpr Color kPaper{14, 18, 24}, kInk{232, 237, 243}, kDim{150, 161, 174}, kDark{10, 13, 18};
constexpr Color kGood{95, 205, 140}, kFair{244, 184, 80}, kBad{255, 105, 97};
constexpr double kGood_px = 0.5, kFair_px = 1.5;  // most row error that is drawn in each color
constexpr double kHeader_px = 28, kFooter_px = 30, kGap_px = 12;

Color colorOf(double error_px) {
  const double size_px = std::abs(error_px);
  return size_px <= kGood_px ? kGood : size_px <= kFair_px ? kFair : kBad;
}

/// The 90th percentile of the errors' magnitudes.
double largeError_px(std::vector<double> errors_px) {
  if (errors_px.empty()) return 0;
  for (double& error_px : errors_px) error_px = std::abs(error_px);
  const auto at = errors_px.begin() + static_cast<std::ptrdiff_t>(errors_px.size() * 9 / 10);
  std::ranges::nth_element(errors_px, at);
  return *at;
}

/// The round factor that enlarges errors such that large ones take about `wanted` pixels of the picture.
double enlargement(double error_px, double scale, double wanted) {
  for (const double factor : {20., 15., 10., 8., 6., 5., 4., 3., 2.})
    if (factor * scale * error_px <= wanted) return factor;
  return 1;
}

/// The match with the median error in each band of rows: enough to see, and without wrong matches.
std::vector<EpipolarMatch> chosen(std::span<const EpipolarMatch> matches, double band_px) {
  std::map<int, std::vector<EpipolarMatch>> bands;
  for (const EpipolarMatch& match : matches) bands[static_cast<int>(match.v_left_px / band_px)].push_back(match);
  std::vector<EpipolarMatch> few;
  for (auto& [band, of_band] : bands) {
    const auto middle = of_band.begin() + std::ssize(of_band) / 2;
    std::ranges::nth_element(of_band, middle, {}, [](const EpipolarMatch& match) { return match.rowDifference_px(); });
    few.push_back(*middle);
  }
  return few;
}

void drawColors(Canvas& canvas, double top, const std::string& note) {
  const TextStyle style{.color = kDim, .size_px = 13};
  const double base = top + 20;
  double left = 12;
  const auto put = [&](Color color, const std::string& text) {
    canvas.dot({left + 5, base - 4.5}, 5, {color, 1});
    canvas.text({left + 17, base}, text, style);
    left += 17 + Canvas::textWidth(text, style) + 24;
  };
  put(kGood, fmt::format("row error up to {:.1f} px", kGood_px));
  put(kFair, fmt::format("up to {:.1f} px", kFair_px));
  put(kBad, "more");
  canvas.text({canvas.width() - 12 - Canvas::textWidth(note, style), base}, note, style);
}

void drawMatch(Canvas& canvas, const Vector2d& from, const Vector2d& to, double bar_px, Color color) {
  const Vector2d end = to + Vector2d(0, bar_px);
  canvas.line(from, to, {.color = color, .width_px = 1, .opacity = 0.6});
  canvas.dot(from, 4.2, {kDark, 0.8});
  canvas.dot(from, 3, {color, 1});
  canvas.line(to, end, {.color = kDark, .width_px = 5, .opacity = 0.7});
  canvas.line(to, end, {.color = color, .width_px = 2.6});
  canvas.dot(end, 4.2, {kDark, 0.8});
  canvas.dot(end, 3, {color, 1});
}

/// An image's scale in a picture of that width.
double scaleTo(double width, const Image& image) { return width / std::max(1, image.width()); }

double usualDisparity_px(std::span<const EpipolarMatch> matches) {
  std::vector<double> disparities_px;
  disparities_px.reserve(matches.size());
  for (const EpipolarMatch& match : matches) disparities_px.push_back(match.disparity_px());
  return median(disparities_px);
}

/// Row errors that the geometry predicts at positions across the image.
std::vector<std::pair<Vector2d, double>> rowErrorField(const Canvas& image, double scale, double disparity_px,
                                                       const PairGeometry& geometry, const StereoCamera& camera) {
  constexpr int kColumns = 17;
  const double step = static_cast<double>(image.width()) / kColumns;
  std::vector<std::pair<Vector2d, double>> field;
  for (double y = step / 2; y < image.height(); y += step)
    for (double x = step / 2; x < image.width(); x += step)
      field.emplace_back(Vector2d(x, y), predictedRowError_px(geometry, camera, x / scale, y / scale, disparity_px));
  return field;
}

/// Draws an arrow of a round row error as a scale.
void drawScale(Canvas& canvas, double top, double shown_per_px) {
  constexpr double kLong_px = 60;
  double unit_px = 0.1;
  for (const double larger_px : {0.2, 0.5, 1., 2., 5., 10., 20.})
    if (larger_px * shown_per_px <= kLong_px) unit_px = larger_px;
  const std::string text = fmt::format("{:g} px of row error", unit_px);
  drawColors(canvas, top, text);
  const double right = canvas.width() - 24 - Canvas::textWidth(text, {.size_px = 13});
  canvas.line({right - shown_per_px * unit_px, top + 15}, {right, top + 15}, {.color = kInk, .width_px = 3});
}

}  // namespace

RgbImage drawEpipolarLines(const MatchedPair& pair) {
  constexpr double kSide_px = 714, kBar_px = 26, kBand_px = 13;
  const double scale = scaleTo(kSide_px, pair.left), height = std::round(scale * pair.left.height());
  Canvas canvas(static_cast<int>(2 * kSide_px + kGap_px), static_cast<int>(kHeader_px + height + kFooter_px), kPaper);
  const double second = kSide_px + kGap_px;
  canvas.paste(pair.left, {0, kHeader_px, kSide_px, height});
  canvas.paste(pair.right, {second, kHeader_px, kSide_px, height});
  const TextStyle head{.color = kInk, .size_px = 14, .bold = true};
  canvas.text({12, 19}, fmt::format("left, frame {}", pair.frame.value), head);
  canvas.text({second + 12, 19}, "right", head);
  std::vector<double> errors_px;
  for (const EpipolarMatch& match : pair.matches) errors_px.push_back(match.rowDifference_px());
  const double factor = enlargement(largeError_px(errors_px), scale, kBar_px);
  Canvas images = canvas.part(0, static_cast<int>(kHeader_px), canvas.width(), static_cast<int>(height));
  for (const EpipolarMatch& match : chosen(pair.matches, kBand_px / scale)) {
    const Vector2d from = scale * Vector2d(match.u_left_px, match.v_left_px),
                   to = Vector2d(second + scale * match.u_right_px, from.y());
    drawMatch(images, from, to, factor * scale * match.rowDifference_px(), colorOf(match.rowDifference_px()));
  }
  drawColors(canvas, kHeader_px + height, fmt::format("bars: the row error, {:.0f} times as large", factor));
  return canvas.image();
}

RgbImage drawRowErrors(const Image& left, std::span<const EpipolarMatch> matches, const PairGeometry& geometry,
                       const StereoCamera& camera) {
  constexpr double kWidth_px = 1100, kArrow_px = 46, kMost = 40;
  const double scale = scaleTo(kWidth_px, left), height = std::round(scale * left.height());
  Canvas canvas(static_cast<int>(kWidth_px), static_cast<int>(height + kFooter_px), kPaper);
  canvas.paste(left, {0, 0, kWidth_px, height});
  Canvas image = canvas.part(0, 0, canvas.width(), static_cast<int>(height));
  const std::array corners{Vector2d(-1, -1), Vector2d(kWidth_px, -1), Vector2d(kWidth_px, height),
                           Vector2d(-1, height)};
  image.fill(corners, {kDark, 0.62});
  const auto field = rowErrorField(image, scale, usualDisparity_px(matches), geometry, camera);
  std::vector<double> errors_px;
  for (const auto& [at, error_px] : field) errors_px.push_back(error_px);
  const double shown_per_px = std::min(kMost * scale, kArrow_px / std::max(1e-6, largeError_px(errors_px)));
  for (const EpipolarMatch& match : matches) {
    const Vector2d at = scale * Vector2d(match.u_left_px, match.v_left_px);
    image.line(at, at + Vector2d(0, shown_per_px * match.rowDifference_px()),
               {.color = colorOf(match.rowDifference_px()), .width_px = 1, .opacity = 0.3});
  }
  for (const auto& [at, error_px] : field) {
    image.dot(at, 2, {kInk, 0.9});
    image.arrow(at, at + Vector2d(0, shown_per_px * error_px), {.color = colorOf(error_px), .width_px = 2.4});
  }
  drawScale(canvas, height, shown_per_px);
  return canvas.image();
}

}  // namespace motorcade
