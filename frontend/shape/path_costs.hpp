#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace motorcade {

/// A byte for each disparity of each pixel of a window. Pixels side by side on a line (a row of the window, or a
/// column) make blocks of kBlock, and a block has its disparities one after the other. So vector arithmetic never
/// crosses lanes. Blocks are full, and lines exist up to a multiple of kBlock; what is beyond the window may hold
/// anything.
class DisparityBlocks {
 public:
  static constexpr int kBlock = 32;
  void resize(int lines, int pixels, int disparities);
  int lines() const { return lines_; }
  int pixels() const { return pixels_; }
  int blocks() const { return blocks_; }
  int disparities() const { return disparities_; }
  std::uint8_t* at(int line, int block) { return bytes_.data() + offset(line, block); }
  const std::uint8_t* at(int line, int block) const { return bytes_.data() + offset(line, block); }

 private:
  std::size_t offset(int line, int block) const {
    return (static_cast<std::size_t>(line) * blocks_ + block) * block_size_;
  }
  int lines_ = 0, pixels_ = 0, blocks_ = 0, disparities_ = 0;
  std::size_t block_size_ = 0;
  std::vector<std::uint8_t> bytes_;
};

/// Path costs of semi-global matching: the sum over paths of the least cost of each disparity of each pixel, minus that
/// of the cheapest way to the pixel before. Keeps its buffers; one call at a time.
class PathCosts {
 public:
  static constexpr int kMostCost = 24;       // of a pixel at a disparity
  static constexpr std::uint8_t kFar = 200;  // beyond the range: more than any sum over four directions

  /// Sums along the four directions of rows and columns; lines of the costs are rows.
  void sum(const DisparityBlocks& costs, DisparityBlocks& sums);

  struct Buffers {
    std::vector<std::uint8_t> path;
    DisparityBlocks costs_of_columns, sums_of_columns;
  };

 private:
  Buffers buffers_;
};

}  // namespace motorcade
