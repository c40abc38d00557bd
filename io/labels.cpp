#include "io/labels.hpp"

#include "io/text_file.hpp"

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

}  // namespace motorcade
