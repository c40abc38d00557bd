#include "io/results/object_points.hpp"

#include "io/files/number_text.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

/// Files of earlier versions name the other columns without their unit.
constexpr std::string_view kHeaderStart = "frame,track_id,point_id";

}  // namespace

std::string objectPointLine(const ObjectPoint& point) {
  std::string line;
  appendInteger(line, point.frame.value);
  for (const std::int64_t id : {point.track.value, point.point.value}) {
    line += ',';
    appendInteger(line, id);
  }
  for (const double value_px : point.uvd_px) {
    line += ',';
    appendFixed(line, value_px, 3);
  }
  return line;
}

std::vector<ObjectPoint> readObjectPoints(const std::filesystem::path& file) {
  std::vector<ObjectPoint> points;
  for (const auto& line : readTable(file, kHeaderStart)) {
    FieldReader fields(file, line, ',');
    ObjectPoint point;
    point.frame.value = fields.integer("frame");
    point.track.value = fields.integer("track_id");
    point.point.value = fields.integer("point_id");
    for (double& value_px : point.uvd_px) value_px = fields.number("pixel");
    fields.expectEnd();
    points.push_back(point);
  }
  return points;
}

}  // namespace motorcade
