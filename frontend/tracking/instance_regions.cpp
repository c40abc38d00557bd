#include "frontend/tracking/instance_regions.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace motorcade {
namespace {

/// Adds the columns `first` to `last` of a row.
void extend(Box& box, int first, int last, int row) {
  box.left_px = std::min<double>(box.left_px, first), box.right_px = std::max<double>(box.right_px, last);
  box.top_px = std::min<double>(box.top_px, row), box.bottom_px = std::max<double>(box.bottom_px, row);
}

}  // namespace

Box upperPart(const Box& region) {
  constexpr double kUpper = 0.6;
  return {region.left_px, region.top_px, region.right_px, region.top_px + kUpper * (region.bottom_px - region.top_px)};
}

std::vector<InstanceRegion> regionsOf(const InstanceLabels& labels) {
  constexpr Box kNowhere{1e9, 1e9, -1e9, -1e9};
  constexpr std::size_t kLabels = std::size_t{std::numeric_limits<std::uint16_t>::max()} + 1;
  std::vector<Box> boxes(kLabels, kNowhere);
  for (int v = 0; v < labels.height(); ++v) {
    const std::uint16_t *const row = labels.row(v), *const end = row + labels.width();
    for (const std::uint16_t* from = row; from != end;) {
      const std::uint16_t label = *from;
      const std::uint16_t* const to = std::find_if(from, end, [label](std::uint16_t other) { return other != label; });
      extend(boxes[label], static_cast<int>(from - row), static_cast<int>(to - row) - 1, v);
      from = to;
    }
  }
  std::vector<InstanceRegion> regions;
  for (std::size_t label = 1; label < kLabels; ++label)
    if (boxes[label].left_px <= boxes[label].right_px)
      regions.push_back({static_cast<std::uint16_t>(label), boxes[label]});
  return regions;
}

}  // namespace motorcade
