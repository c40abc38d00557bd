#include "frontend/image/detail_search.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "core/instruction_set.hpp"

#define HWY_TARGET_INCLUDE "frontend/image/detail_search.cpp"
#include <hwy/foreach_target.h>

#include "frontend/image/pixel_lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

constexpr int kMeanColumns = 9, kMeanRows = 5, kMargin = kMeanColumns / 2;
constexpr int kMidGray = 128;
constexpr int kNeighbors_px = 2;  // of the least sum, which do not speak against it
static_assert(kMeanColumns * kMeanRows * UINT8_MAX <= INT16_MAX && kMaxWindowCosts == 32 * kWordLanes);

/// Sums over the rows around row y, with a margin on both sides that repeats the last columns, the right one for whole
/// vectors beyond the image.
void sumRows(const Image& image, int y, std::int16_t* sums) {
  std::array<const std::uint8_t*, kMeanRows> rows;
  for (int r = 0; r < kMeanRows; ++r) rows[r] = image.row(std::clamp(y + r - kMeanRows / 2, 0, image.height() - 1));
  for (int x = 0; x < image.width(); x += kWordLanes) {
    Words sum{};
    for (const std::uint8_t* row : rows) sum += wordPixels(row + x);
    store(sums + kMargin + x, sum);
  }
  std::fill_n(sums, kMargin, sums[kMargin]);
  std::fill_n(sums + kMargin + image.width(), kMargin + kWordLanes, sums[kMargin + image.width() - 1]);
}

/// `sums` are those of the rows, as `sumRows` leaves them.
void subtractMeans(const std::uint8_t* row, const std::int16_t* sums, int width, std::uint8_t* out) {
  const Words per_pixel = allWords((1 << 15) / (kMeanColumns * kMeanRows));  // as `scaled` takes fractions
  const Words middle = allWords(kMidGray), black = allWords(0), white = allWords(UINT8_MAX);
  for (int x = 0; x < width; x += kWordLanes) {
    Words sum{};
    for (int c = 0; c < kMeanColumns; ++c) sum += load(sums + x + c);
    const Words detail = wordPixels(row + x) - scaled(sum, per_pixel) + middle;
    storeWordsAsBytes(out + x, lesser(greater(detail, black), white));
  }
}

constexpr int kMaxBlocks = kMaxWindowCosts / kWordLanes;

int blocksOf(int count) { return (count + kWordLanes - 1) / kWordLanes; }

/// Columns whose details differ by this many times as much as the best ones do are not compared any further.
constexpr float kWorthComparing = 1.5F;

/// Of `count` columns from `from` on, the blocks of sixteen that are worth comparing, by 8x5 pixels of the details.
std::uint32_t promisingBlocks(const std::uint8_t* window, std::ptrdiff_t window_stride, const std::uint8_t* from,
                              std::ptrdiff_t stride, int count) {
  std::array<std::int16_t, kMaxBlocks> least;
  const int blocks = blocksOf(count);
  for (int b = 0; b < blocks; ++b) {
    Words sum{};
    for (int r = 0; r < kHalfSizeWindow.rows; ++r)
      sum += differencesOfEight(from + b * kWordLanes + r * stride, window + r * window_stride);
    least[b] = leastOf(choose(wordNumbers() < allWords(count - b * kWordLanes), sum, allWords(INT16_MAX)));
  }
  const float worth = kWorthComparing * *std::min_element(least.begin(), least.begin() + blocks);
  std::uint32_t promising = 0;
  for (int b = 0; b < blocks; ++b) promising |= std::uint32_t{least[b] <= worth} << b;
  return promising;
}

/// Costs of neighboring columns, with the least of each block of sixteen.
class Costs {
 public:
  explicit Costs(int count) : blocks_(blocksOf(count)), count_(count) {}

  std::span<std::uint16_t> all() { return std::span(costs_).first(count_); }
  /// To be called when the costs of these blocks are filled: the others are as good as infinite.
  void findLeast(std::uint32_t filled) {
    for (int b = 0; b < blocks_; ++b) {
      const bool is_filled = (filled >> b & 1) != 0;
      if (!is_filled) store(at(b), allWords(INT16_MAX));
      least_[b] = is_filled ? leastOf(block(b)) : INT16_MAX;
    }
  }
  std::int16_t least() const { return *std::min_element(least_.begin(), least_.begin() + blocks_); }
  int first(std::int16_t cost) const {
    const auto b = static_cast<int>(std::find(least_.begin(), least_.begin() + blocks_, cost) - least_.begin());
    const auto* const begin = costs_.data() + b * kWordLanes;
    return static_cast<int>(std::find(begin, begin + kWordLanes, cost) - costs_.data());
  }
  /// The least cost of columns that are no neighbors of column i; INT16_MAX where there are none.
  std::int16_t leastBesides(int i) {
    for (const int b : {std::max(0, i - kNeighbors_px) / kWordLanes, (i + kNeighbors_px) / kWordLanes}) {
      if (b >= blocks_) continue;
      const Words place = wordNumbers() + allWords(b * kWordLanes - i);
      least_[b] = leastOf(choose(magnitude(place) > allWords(kNeighbors_px), block(b), allWords(INT16_MAX)));
    }
    return least();
  }

 private:
  std::int16_t* at(int b) { return reinterpret_cast<std::int16_t*>(costs_.data()) + b * kWordLanes; }
  Words block(int b) const {
    const Words words = load(reinterpret_cast<const std::int16_t*>(costs_.data()) + b * kWordLanes);
    return choose(wordNumbers() < allWords(count_ - b * kWordLanes), words, allWords(INT16_MAX));
  }

  int blocks_, count_;
  std::array<std::int16_t, kMaxBlocks> least_;
  std::array<std::uint16_t, kMaxWindowCosts> costs_;
};

}  // namespace

DetailedImage addDetail(const Image& image, ImagePool& pool) {
  DetailedImage detailed{image, pool.acquire(image.width(), image.height())};
  const auto sums = std::make_unique_for_overwrite<std::int16_t[]>(image.width() + 2 * (kMargin + kWordLanes));
  for (int y = 0; y < image.height(); ++y) {
    sumRows(image, y, sums.get());
    subtractMeans(image.row(y), sums.get(), image.width(), detailed.detail.mutableRow(y));
  }
  return detailed;
}

std::optional<int> search(const DetailedImage& from, int u, int v, const DetailedImage& to, ColumnRange range,
                          double max_ratio) {
  constexpr int kHalfColumns = kHalfSizeWindow.columns / 2, kHalfRows = kHalfSizeWindow.rows / 2;
  const int first_u = std::max(range.first, kHalfColumns);
  const int last_u = std::min({range.last, to.image.width() - 1 - kHalfColumns, first_u + kMaxWindowCosts - 1});
  if (last_u < first_u) return std::nullopt;
  const Window window{from.image, u, v, kHalfSizeWindow};
  assert(window.insideImage());
  Costs costs(last_u - first_u + 1);
  const std::uint32_t promising =
      promisingBlocks(from.detail.row(v - kHalfRows) + u - kHalfColumns, from.detail.stride(),
                      to.detail.row(v - kHalfRows) + first_u - kHalfColumns, to.detail.stride(), last_u - first_u + 1);
  windowDifferences(window, to.image, first_u, v, costs.all(), promising);
  costs.findLeast(promising);
  const std::int16_t least = costs.least();
  const int best = costs.first(least);
  const std::int16_t second = costs.leastBesides(best);
  if (second < INT16_MAX && least > max_ratio * second) return std::nullopt;
  return first_u + best;
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(addDetail);
MOTORCADE_EXPORT(search);

DetailedImage withDetail(const Image& image, ImagePool& pool) { return MOTORCADE_KERNEL(addDetail)(image, pool); }

std::optional<int> searchRow(const DetailedImage& from, int u, int v, const DetailedImage& to, ColumnRange range,
                             double max_ratio) {
  return MOTORCADE_KERNEL(search)(from, u, v, to, range, max_ratio);
}

}  // namespace motorcade
#endif
