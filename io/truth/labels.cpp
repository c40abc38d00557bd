#include "io/truth/labels.hpp"

#include <cmath>
#include <numbers>

#include "io/files/number_text.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {

std::vector<Label> readLabels(const std::filesystem::path& file) {
  std::vector<Label> labels;
  for (const auto& line : readLines(file)) {
    FieldReader fields(file, line);
    Label label;
    label.frame.value = fields.integer("frame");
    label.track = fields.integer("track id");
    label.type = fields.word("type");
    label.truncated = fields.number("truncated");
    label.occluded = static_cast<int>(fields.integer("occluded"));
    fields.number("alpha");
    for (double* edge_px : {&label.box.left_px, &label.box.top_px, &label.box.right_px, &label.box.bottom_px})
      *edge_px = fields.number("box");
    for (double& side_m : label.size_m) side_m = fields.number("size");
    for (double& place_m : label.location_m) place_m = fields.number("location");
    label.rotation_y_rad = fields.number("rotation_y");
    if (label.frame.value < 0) fields.fail("the frame is negative");
    labels.push_back(std::move(label));
  }
  return labels;
}

std::string resultLine(const Label& label, double score) {
  const double bearing_rad = std::atan2(label.location_m.x(), label.location_m.z()),
               alpha_rad = std::remainder(label.rotation_y_rad - bearing_rad, 2 * std::numbers::pi);
  std::string line;
  appendInteger(line, label.frame.value);
  line += ' ';
  appendInteger(line, label.track);
  line.append(" ").append(label.type).append(" -1 -1");
  const auto add = [&](double value) {
    line += ' ';
    appendFixed(line, value, 6);
  };
  add(alpha_rad);
  for (const double edge_px : {label.box.left_px, label.box.top_px, label.box.right_px, label.box.bottom_px})
    add(edge_px);
  for (const double side_m : label.size_m) add(side_m);
  for (const double place_m : label.location_m) add(place_m);
  add(label.rotation_y_rad);
  add(score);
  return line;
}

}  // namespace motorcade
