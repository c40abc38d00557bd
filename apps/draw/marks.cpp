#include "apps/draw/marks.hpp"

#include <array>
#include <functional>
#include <string_view>
#include <vector>

#include "apps/draw/palette.hpp"

namespace motorcade {
namespace {

using Eigen::Vector2d;

constexpr double kSampleWidth_px = 28, kGap_px = 8, kSpace_px = 22, kRow_px = 20, kEdge_px = 14;
constexpr Color kSample{200, 209, 219};
const TextStyle kText{.color = kDimInk, .size_px = 11};

/// Draws a sample about a point, at most 28 px wide and 14 px high.
using Sampler = std::function<void(Canvas&, const Vector2d&)>;

struct Entry {
  Mark mark;
  std::string_view text;
  Sampler draw;
};

std::vector<Vector2d> boxAbout(const Vector2d& at, double half_width, double half_height) {
  return {at + Vector2d(-half_width, -half_height), at + Vector2d(half_width, -half_height),
          at + Vector2d(half_width, half_height), at + Vector2d(-half_width, half_height)};
}

Sampler lineSample(const Pen& pen) {
  return [pen](Canvas& canvas, const Vector2d& at) { canvas.line(at - Vector2d(13, 0), at + Vector2d(13, 0), pen); };
}

Sampler outlineSample(const Pen& pen, double inside = 0) {
  return [pen, inside](Canvas& canvas, const Vector2d& at) {
    const auto corners = boxAbout(at, 12, 5);
    if (inside > 0) canvas.fill(corners, {pen.color, inside});
    canvas.outline(corners, pen);
  };
}

void drawCuboidSample(Canvas& canvas, const Vector2d& at) {
  const Pen pen{.color = kSample, .width_px = 1.4};
  const Vector2d back(6, -4);
  const auto front = boxAbout(at - 0.5 * back, 7, 4);
  canvas.outline(front, pen);
  const std::array behind{front[0], Vector2d(front[0] + back), Vector2d(front[1] + back), Vector2d(front[2] + back),
                          front[2]};
  canvas.polyline(behind, pen);
  canvas.line(front[1], front[1] + back, pen);
}

void drawPointSample(Canvas& canvas, const Vector2d& at) {
  for (const double x : {-7, 0, 7}) canvas.dot(at + Vector2d(x, 0), 2, {kInk, 1});
}

void drawEllipseSample(Canvas& canvas, const Vector2d& at) {
  const auto corners = ellipse(at, Vector2d(12, 5).asDiagonal().toDenseMatrix());
  canvas.fill(corners, {kSample, 0.18});
  canvas.outline(corners, {.color = kSample, .width_px = 1.2});
}

void drawOwnSample(Canvas& canvas, const Vector2d& at) {
  const std::array corners{Vector2d(at + Vector2d(2, 0)), Vector2d(at + Vector2d(-12, 6)),
                           Vector2d(at + Vector2d(-9, 0)), Vector2d(at + Vector2d(-12, -6))};
  const std::array view{Vector2d(at - Vector2d(6, 0)), Vector2d(at + Vector2d(14, -8)), Vector2d(at + Vector2d(14, 8))};
  canvas.fill(view, {kOwn, 0.25});
  canvas.fill(corners, {kOwn, 1});
}

std::vector<Entry> entries() {
  const Sampler arrow = [](Canvas& canvas, const Vector2d& at) {
    canvas.arrow(at - Vector2d(13, 0), at + Vector2d(13, 0), {.color = kSample, .width_px = 2});
  };
  const Sampler sigma = [](Canvas& canvas, const Vector2d& at) {
    canvas.text(at + Vector2d(-6, 5), "±", {.color = kInk, .size_px = 14, .bold = true});
  };
  return {
      {Mark::kMask, "pixels that show it", outlineSample({.color = kSample, .width_px = 1.5}, 0.4)},
      {Mark::kCuboid, "cuboid", drawCuboidSample},
      {Mark::kBox, "box in the image", outlineSample({.color = kSample, .width_px = 2})},
      {Mark::kPredicted, "predicted, not seen",
       outlineSample({.color = kSample, .width_px = 1.5, .dashes_px = {4, 3}})},
      {Mark::kPoint, "followed points", drawPointSample},
      {Mark::kWay, "way so far", lineSample({.color = kSample, .width_px = 2})},
      {Mark::kEarlierWay, "way of one no longer followed",
       lineSample({.color = kSample, .width_px = 1.5, .opacity = 0.4})},
      {Mark::kMotion, "motion in 1 s", arrow},
      {Mark::kTag, "one sigma", sigma},
      {Mark::kFootprint, "footprint, as far as seen", outlineSample({.color = kSample, .width_px = 1}, 0.85)},
      {Mark::kEllipse, "2 sigma of its middle", drawEllipseSample},
      {Mark::kOwnCamera, "own camera and view", drawOwnSample},
      {Mark::kOwnPath, "own path", lineSample({.color = kOwn, .width_px = 3})},
      {Mark::kTrueMover, "truth, moving", outlineSample({.color = kTruth, .width_px = 1.4, .dashes_px = {5, 3}})},
      {Mark::kTrueParked, "truth, parked",
       outlineSample({.color = kDimInk, .width_px = 1.2, .dashes_px = {1.5, 2.5}}, 0.12)},
      {Mark::kTruePath, "true way", lineSample({.color = kTruth, .width_px = 1.2, .dashes_px = {5, 4}})},
  };
}

double widthOf(const Entry& entry) { return kSampleWidth_px + kGap_px + Canvas::textWidth(entry.text, kText); }

/// Position of each entry, row by row.
std::vector<Vector2d> flowed(const std::vector<Entry>& shown, int width) {
  std::vector<Vector2d> places;
  Vector2d at(kEdge_px, 0.5 * kRow_px + kEdge_px / 2);
  for (const Entry& entry : shown) {
    const double needed = widthOf(entry);
    if (at.x() > kEdge_px && at.x() + needed > width - kEdge_px) at = {kEdge_px, at.y() + kRow_px};
    places.push_back(at);
    at.x() += needed + kSpace_px;
  }
  return places;
}

}  // namespace

bool Sheet::note(Mark mark, Canvas::Points points) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vector2d& from = points[i > 0 ? i - 1 : 0];
    if (!from.allFinite() || !points[i].allFinite()) continue;
    const Vector2d least = from.cwiseMin(points[i]), size = (points[i] - from).cwiseAbs();
    if (area().overlap(Rectangle{least.x(), least.y(), size.x(), size.y()}.grownBy(0.5)) <= 0) continue;
    marks.insert(mark);
    return true;
  }
  return false;
}

int legendHeight(int width) {
  return static_cast<int>(flowed(entries(), width).back().y() + 0.5 * kRow_px + kEdge_px / 2);
}

void drawLegend(Canvas& canvas, const Marks& marks) {
  std::vector<Entry> shown = entries();
  std::erase_if(shown, [&](const Entry& entry) { return !marks.contains(entry.mark); });
  const auto places = flowed(shown, canvas.width());
  for (std::size_t i = 0; i < shown.size(); ++i) {
    shown[i].draw(canvas, places[i] + Vector2d(0.5 * kSampleWidth_px, 0));
    canvas.text(places[i] + Vector2d(kSampleWidth_px + kGap_px, 4), shown[i].text, kText);
  }
}

}  // namespace motorcade
