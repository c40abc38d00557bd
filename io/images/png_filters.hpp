#pragma once

#include <cstddef>
#include <cstdint>

namespace motorcade {

/// A row of a PNG as it was packed: each byte less the prediction from its neighbors, by the filter that the row names.
struct FilteredRow {
  const std::uint8_t* bytes;
  const std::uint8_t* above;  // the row before, without its filter; of the first row: zeros
  std::size_t count;          // bytes, whole pixels
};

/// Undoes a filter on a row of pixels of 1 to 4 bytes. `to` may be the row itself. False when the filter is unknown.
bool removeFilter(int filter, int pixel_bytes, FilteredRow row, std::uint8_t* to);

}  // namespace motorcade
