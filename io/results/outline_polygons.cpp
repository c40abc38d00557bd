#include "io/results/outline_polygons.hpp"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "io/files/number_text.hpp"
#include "io/images/mask_runs.hpp"

namespace motorcade {
namespace {

/// The mask's pixels that lie in the image, and the position of the first of them.
struct Pixels {
  cv::Mat inside;
  int left_px, top_px;
};

Pixels pixelsOf(const ObjectMask& mask, int width_px, int height_px) {
  const int left = std::max(mask.left_px, 0), top = std::max(mask.top_px, 0),
            right = std::min(mask.left_px + mask.width * mask.cell_px, width_px),
            bottom = std::min(mask.top_px + mask.height * mask.cell_px, height_px);
  cv::Mat inside = cv::Mat::zeros(std::max(bottom - top, 0), std::max(right - left, 0), CV_8U);
  forEachRun(mask, width_px, height_px, [&](const MaskRun& run) {
    for (int v = run.v_begin; v < run.v_end; ++v)
      std::fill_n(inside.ptr(v - top) + (run.u_begin - left), run.u_end - run.u_begin, std::uint8_t{1});
  });
  return {inside, left, top};
}

}  // namespace

std::vector<Polygon> outlinePolygons(const ObjectMask& mask, int width_px, int height_px) {
  constexpr double kStairs_cells = 0.75;  // the corners of stairs lie sqrt(1/2) cells off their diagonal
  const Pixels pixels = pixelsOf(mask, width_px, height_px);
  if (pixels.inside.empty()) return {};
  std::vector<std::vector<cv::Point>> borders;
  cv::findContours(pixels.inside, borders, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_SIMPLE,
                   cv::Point(pixels.left_px, pixels.top_px));
  std::ranges::stable_sort(borders, std::ranges::greater{},
                           [](const std::vector<cv::Point>& border) { return cv::contourArea(border); });
  std::vector<Polygon> polygons;
  for (const auto& border : borders) {
    std::vector<cv::Point> corners;
    cv::approxPolyDP(border, corners, kStairs_cells * mask.cell_px, true);
    if (corners.size() < 3) continue;
    Polygon& polygon = polygons.emplace_back();
    for (const cv::Point& corner : corners) polygon.emplace_back(corner.x, corner.y);
  }
  return polygons;
}

std::string outlineLine(FrameId frame, TrackId track, const std::vector<Polygon>& polygons) {
  std::string line = R"({"frame":)";
  appendInteger(line, frame.value);
  line += R"(,"track_id":)";
  appendInteger(line, track.value);
  line += R"(,"polygons":[)";
  for (const Polygon& polygon : polygons) {
    line += line.back() == '[' ? "[" : ",[";
    for (const auto& corner : polygon) {
      line += line.back() == '[' ? "[" : ",[";
      appendInteger(line, corner.x());
      line += ',';
      appendInteger(line, corner.y());
      line += ']';
    }
    line += ']';
  }
  return line + "]}";
}

}  // namespace motorcade
