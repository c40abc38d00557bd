#include "frontend/shape/path_costs.hpp"

#include <array>
#include <cstring>
#include <utility>

#include "core/instruction_set.hpp"

#define HWY_TARGET_INCLUDE "frontend/shape/path_costs.cpp"
#include <hwy/foreach_target.h>

#include "frontend/image/pixel_lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

constexpr std::uint8_t kStep = 5;   // penalty for a change of the disparity by one, along a path
constexpr std::uint8_t kJump = 22;  // and for a greater one
static_assert(4 * (PathCosts::kMostCost + kJump) < PathCosts::kFar && PathCosts::kFar + kStep <= UINT8_MAX);

enum class Sum { kStart, kContinue };

/// One pixel farther along kByteLanes paths side by side. `path`: their costs so far, and kFar as the last;
/// `least`: of each. Returns the least of the new ones.
template <Sum kSum>
Bytes stepAlong(std::uint8_t* path, const Bytes& least, const std::uint8_t* costs, std::uint8_t* sums,
                int disparities) {
  Bytes below = PathCosts::kFar, same = load(path) - least, least_yet = PathCosts::kFar;
  for (int d = 0; d < disparities; ++d, path += kByteLanes, costs += kByteLanes, sums += kByteLanes) {
    const Bytes above = load(path + kByteLanes) - least;
    const Bytes way = lesser(lesser(lesser(below, above) + kStep, same), kJump);
    const Bytes next = load(costs) + way;
    store(path, next);
    store(sums, kSum == Sum::kStart ? next : load(sums) + next);
    least_yet = lesser(least_yet, next);
    below = same, same = above;
  }
  return least_yet;
}

constexpr int kTile = 16;
using TileRow = std::uint8_t __attribute__((vector_size(kTile)));
using Tile = std::array<TileRow, kTile>;

TileRow lowerOf(const TileRow& a, const TileRow& b) {
  return __builtin_shufflevector(a, b, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
}
TileRow upperOf(const TileRow& a, const TileRow& b) {
  return __builtin_shufflevector(a, b, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
}

/// Shuffled as cards are, four times.
void transpose(Tile& tile) {
  for (int time = 0; time < 4; ++time) {
    Tile shuffled;
    for (int i = 0; i < kTile / 2; ++i) {
      shuffled[2 * i] = lowerOf(tile[i], tile[i + kTile / 2]);
      shuffled[2 * i + 1] = upperOf(tile[i], tile[i + kTile / 2]);
    }
    tile = shuffled;
  }
}

/// The places of a tile of both: kTile lines from `line` on, and as many pixels from `pixel` on.
struct TilePlace {
  int line, pixel;
};

template <Sum kSum>
void transposeTiles(const DisparityBlocks& from, TilePlace place, DisparityBlocks& to) {
  for (int d = 0; d < from.disparities(); ++d) {
    const auto at = [d](auto& blocks, int line, int pixel)
                        HWY_ATTR { return blocks.at(line, pixel / kByteLanes) + d * kByteLanes + pixel % kByteLanes; };
    Tile tile;
    for (int i = 0; i < kTile; ++i) std::memcpy(&tile[i], at(from, place.line + i, place.pixel), kTile);
    transpose(tile);
    for (int i = 0; i < kTile; ++i) {
      std::uint8_t* row = at(to, place.pixel + i, place.line);
      TileRow before{};
      if (kSum == Sum::kContinue) std::memcpy(&before, row, kTile);
      tile[i] += before;
      std::memcpy(row, &tile[i], kTile);
    }
  }
}

/// What is on lines is across them in the other.
template <Sum kSum>
void transpose(const DisparityBlocks& from, DisparityBlocks& to) {
  for (int line = 0; line < from.lines(); line += kTile)
    for (int pixel = 0; pixel < from.pixels(); pixel += kTile) transposeTiles<kSum>(from, {line, pixel}, to);
}

/// Along the paths from the first line to the last and back.
void sumAcrossLines(const DisparityBlocks& costs, std::vector<std::uint8_t>& path, DisparityBlocks& sums) {
  const int disparities = costs.disparities();
  for (int block = 0; block < costs.blocks(); ++block) {
    path.assign(static_cast<std::size_t>(kByteLanes) * (disparities + 1), 0);
    store(path.data() + static_cast<std::ptrdiff_t>(kByteLanes) * disparities, PathCosts::kFar);
    Bytes least{};
    for (int line = 0; line < costs.lines(); ++line)
      least = stepAlong<Sum::kStart>(path.data(), least, costs.at(line, block), sums.at(line, block), disparities);
    std::fill(path.data(), path.data() + static_cast<std::ptrdiff_t>(kByteLanes) * disparities, 0);
    least = Bytes{};
    for (int line = costs.lines() - 1; line >= 0; --line)
      least = stepAlong<Sum::kContinue>(path.data(), least, costs.at(line, block), sums.at(line, block), disparities);
  }
}

}  // namespace

void sumAlongPaths(const DisparityBlocks& costs, PathCosts::Buffers& buffers, DisparityBlocks& sums) {
  sumAcrossLines(costs, buffers.path, sums);
  transpose<Sum::kStart>(costs, buffers.costs_of_columns);
  sumAcrossLines(buffers.costs_of_columns, buffers.path, buffers.sums_of_columns);
  transpose<Sum::kContinue>(buffers.sums_of_columns, sums);
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(sumAlongPaths);

void DisparityBlocks::resize(int lines, int pixels, int disparities) {
  const auto blocksFor = [](int count) { return (count + kBlock - 1) / kBlock; };
  lines_ = lines, pixels_ = pixels, blocks_ = blocksFor(pixels), disparities_ = disparities;
  block_size_ = static_cast<std::size_t>(kBlock) * disparities;
  bytes_.resize(offset(blocksFor(lines) * kBlock, 0));
}

void PathCosts::sum(const DisparityBlocks& costs, DisparityBlocks& sums) {
  sums.resize(costs.lines(), costs.pixels(), costs.disparities());
  buffers_.costs_of_columns.resize(costs.pixels(), costs.lines(), costs.disparities());
  buffers_.sums_of_columns.resize(costs.pixels(), costs.lines(), costs.disparities());
  MOTORCADE_KERNEL(sumAlongPaths)(costs, buffers_, sums);
}

}  // namespace motorcade
#endif
