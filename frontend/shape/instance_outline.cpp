#include "frontend/shape/instance_outline.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

namespace motorcade {
namespace {

/// Number of the window's cells that a label covers.
struct Cover {
  int cells = 0, shared = 0;  // shared with the outline
  bool goes_on = false;       // beyond the window
};

/// The label at the middle of each cell.
std::vector<std::uint16_t> labelsOfCells(const Outline& outline, const LevelDisparities& disparities,
                                         const InstanceLabels& labels) {
  std::vector<std::uint16_t> of_cells;
  of_cells.reserve(outline.inside.size());
  for (int row = 0; row < outline.window.height; ++row)
    for (int column = 0; column < outline.window.width; ++column)
      of_cells.push_back(labels.at(disparities.u_px(column), disparities.v_px(row)));
  return of_cells;
}

}  // namespace

std::optional<Outline> labelledOutline(const Outline& outline, const LevelDisparities& disparities,
                                       const InstanceLabels& labels) {
  const std::vector<std::uint16_t> of_cells = labelsOfCells(outline, disparities, labels);
  const int width = outline.window.width, height = outline.window.height;
  const PixelWindow& window = outline.window;
  const int image_columns = labels.width() >> disparities.level, image_rows = labels.height() >> disparities.level;
  const auto isBorder = [&](int column, int row) {  // of the window, within the image
    return (column == 0 && window.u0 > 0) || (column == width - 1 && window.u0 + width < image_columns) ||
           (row == 0 && window.v0 > 0) || (row == height - 1 && window.v0 + height < image_rows);
  };
  std::map<std::uint16_t, Cover> covers;
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const std::uint16_t label = of_cells[static_cast<std::size_t>(row) * width + column];
      if (label == 0) continue;
      Cover& cover = covers[label];
      ++cover.cells;
      cover.shared += outline.at(column, row);
      cover.goes_on = cover.goes_on || isBorder(column, row);
    }
  const int own = outline.count();
  for (const auto& [label, cover] : covers) {
    if (cover.goes_on || 2 * cover.shared <= own + cover.cells - cover.shared) continue;
    Outline labelled{.window = outline.window, .inside = {}};
    for (const std::uint16_t of_cell : of_cells) labelled.inside.push_back(of_cell == label ? 1 : 0);
    return labelled;
  }
  return std::nullopt;
}

}  // namespace motorcade
