#pragma once

#include <algorithm>

#include "core/messages.hpp"

namespace motorcade {

/// A rectangle of pixels [begin, end) that a mask shows: cells side by side in one row of cells, as far as they are in
/// the image.
struct MaskRun {
  int u_begin, u_end, v_begin, v_end;
};

/// Visits the runs of a mask within an image of the given size.
template <class Visit>
void forEachRun(const ObjectMask& mask, int width_px, int height_px, const Visit& visit) {
  const auto uAt = [&](int column) { return std::clamp(mask.left_px + column * mask.cell_px, 0, width_px); };
  const auto vAt = [&](int row) { return std::clamp(mask.top_px + row * mask.cell_px, 0, height_px); };
  for (int row = 0; row < mask.height; ++row) {
    for (int first = 0, end = 0; first < mask.width; first = end) {
      for (end = first + 1; end < mask.width && mask.at(end, row) == mask.at(first, row);) ++end;
      const MaskRun run{uAt(first), uAt(end), vAt(row), vAt(row + 1)};
      if (mask.at(first, row) && run.u_begin < run.u_end && run.v_begin < run.v_end) visit(run);
    }
  }
}

}  // namespace motorcade
