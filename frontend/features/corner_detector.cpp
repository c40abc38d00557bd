#include "frontend/features/corner_detector.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "core/instruction_set.hpp"
#include "frontend/image/grain.hpp"
#include "frontend/parallel_items.hpp"

#define HWY_TARGET_INCLUDE "frontend/features/corner_detector.cpp"
#include <hwy/foreach_target.h>

#include "core/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

constexpr int kHalfWindow_px = 3;  // second moments are summed over 7x7 pixels
constexpr int kWindowRows = 2 * kHalfWindow_px + 1, kWindowPixels = kWindowRows * kWindowRows;

constexpr int kMinDistance_px = CornerDetector::kMinDistance_px;
/// Rows and columns along the border without corners: responses reach as far as window, smoothing and distance.
constexpr int kBorder_px = kHalfWindow_px + 2 + kMinDistance_px;
/// Least ratio of a corner's score to the standard deviation of the pixel noise that would look as rough as the
/// corner's neighborhood does.
constexpr double kMinScoreOverGrain = 0.5;

/// The last rows of values computed row by row, by row number.
template <class T>
class RowRing {
 public:
  RowRing(int rows, int width) : rows_(rows), width_(width), values_(rows * width) {}
  T* row(int y) { return values_.data() + y % rows_ * width_; }
  const T* row(int y) const { return values_.data() + y % rows_ * width_; }

 private:
  int rows_, width_;
  std::vector<T> values_;
};

/// Gradients of the image smoothed by the binomial 3x3 filter, scaled by 32, row after row. Without smoothing the grain
/// of dark images would look like corners.
class Gradients {
 public:
  explicit Gradients(const Image& image)
      : image_(image),
        columns_(image.width()),
        smooth_(3, image.width()),
        dx_(kRows, image.width()),
        dy_(kRows, image.width()) {}

  /// Computes row y. Rows are computed in order, and the last `kRows` are kept.
  void advanceTo(int y) {
    for (int next = smoothed_to_ < 0 ? y - 1 : smoothed_to_ + 1; next <= y + 1; ++next) smooth(next);
    smoothed_to_ = y + 1;
    const std::int16_t *above = smooth_.row(y - 1), *row = smooth_.row(y), *below = smooth_.row(y + 1);
    std::int16_t *dx = dx_.row(y), *dy = dy_.row(y);
    for (int x = 2; x < image_.width() - 2; ++x) {
      dx[x] = static_cast<std::int16_t>(row[x + 1] - row[x - 1]);
      dy[x] = static_cast<std::int16_t>(below[x] - above[x]);
    }
  }
  const std::int16_t* dx(int y) const { return dx_.row(y); }
  const std::int16_t* dy(int y) const { return dy_.row(y); }
  static constexpr double kScale = 32;
  static constexpr int kRows = kWindowRows + 1;  // those of the window and the one that leaves it, zero at first

 private:
  void smooth(int y) {
    const std::uint8_t *above = image_.row(y - 1), *row = image_.row(y), *below = image_.row(y + 1);
    std::int16_t *column = columns_.data(), *out = smooth_.row(y);
    for (int x = 0; x < image_.width(); ++x) column[x] = static_cast<std::int16_t>(above[x] + 2 * row[x] + below[x]);
    for (int x = 1; x < image_.width() - 1; ++x)
      out[x] = static_cast<std::int16_t>(column[x - 1] + 2 * column[x] + column[x + 1]);
  }

  const Image& image_;
  std::vector<std::int16_t> columns_;
  RowRing<std::int16_t> smooth_, dx_, dy_;
  int smoothed_to_ = -1;
};

/// Column sums of the products of gradients over the window's rows, which slide down the image.
struct ColumnMoments {
  std::vector<int> xx, xy, yy;
  explicit ColumnMoments(int width) : xx(width), xy(width), yy(width) {}

  /// Adds the products of row y and subtracts those of the row that leaves the window, which is zero at first.
  void slideTo(const Gradients& gradients, int y) {
    const std::int16_t *dx = gradients.dx(y), *dy = gradients.dy(y);
    // The row that leaves, y - kWindowRows, and this one share a slot of the ring; this one is never negative.
    const int leaving = y - kWindowRows + Gradients::kRows;
    const std::int16_t *old_dx = gradients.dx(leaving), *old_dy = gradients.dy(leaving);
    int *sum_xx = xx.data(), *sum_xy = xy.data(), *sum_yy = yy.data();
    for (int x = 0; x < static_cast<int>(xx.size()); ++x) {
      const int gx = dx[x], gy = dy[x], old_gx = old_dx[x], old_gy = old_dy[x];
      sum_xx[x] += gx * gx - old_gx * old_gx;
      sum_xy[x] += gx * gy - old_gx * old_gy;
      sum_yy[x] += gy * gy - old_gy * old_gy;
    }
  }
};

int windowSum(const int* columns) {
  int sum = 0;
  for (int k = -kHalfWindow_px; k <= kHalfWindow_px; ++k) sum += columns[k];
  return sum;
}

/// Smaller eigenvalue of the second moments along a row.
void smallerEigenvalues(const ColumnMoments& moments, int first, int last, float* out) {
  const int *xx = moments.xx.data(), *xy = moments.xy.data(), *yy = moments.yy.data();
  for (int x = first; x < last; ++x) {
    const auto a = static_cast<float>(windowSum(xx + x)), b = static_cast<float>(windowSum(xy + x)),
               c = static_cast<float>(windowSum(yy + x));
    out[x] = 0.5F * (a + c - std::sqrt((a - c) * (a - c) + 4 * b * b));
  }
}

/// True for the greatest value within the minimum distance; of equal ones for the first in reading order.
bool isMaximum(const RowRing<float>& response, int x, int y) {
  // Two vectors, one lane apart, cover the columns; those of the value's own row lie on either side of it.
  static_assert(kMinDistance_px == 4);
  const float* here = response.row(y) + x;
  constexpr unsigned kLeft = 0b1111;
  const Floats value = *here, own = load(here - kMinDistance_px), right_end = load(here - kMinDistance_px + 1);
  if ((bitsOf(own >= value) & kLeft) != 0 || (bitsOf(right_end > value) & ~kLeft) != 0) return false;
  for (int dy = 1; dy <= kMinDistance_px; ++dy) {
    const float *above = response.row(y - dy) + x - kMinDistance_px,
                *below = response.row(y + dy) + x - kMinDistance_px;
    if (anyOf((load(above) >= value) | (load(above + 1) >= value) | (load(below) > value) | (load(below + 1) > value)))
      return false;
  }
  return true;
}

/// Marks pixels of row y above the threshold that no direct neighbor exceeds: a cheap filter that compiles to vector
/// code.
void markPeaks(const RowRing<float>& response, int y, int first, int last, float threshold, std::uint8_t* marks) {
  const float *above = response.row(y - 1), *row = response.row(y), *below = response.row(y + 1);
  for (int x = first; x < last; ++x) {
    const float beside = std::max(row[x - 1], row[x + 1]);
    const float upper = std::max(std::max(above[x - 1], above[x]), above[x + 1]);
    const float lower = std::max(std::max(below[x - 1], below[x]), below[x + 1]);
    const float around = std::max(beside, std::max(upper, lower));
    marks[x] = static_cast<std::uint8_t>(row[x] >= std::max(around, threshold));
  }
}

/// The first mark at x or after it, eight at a time; at least the row's end when there is none. Zeros follow the row.
int nextMark(const std::vector<std::uint8_t>& marks, int x) {
  const int end = static_cast<int>(marks.size() - sizeof(std::uint64_t));
  for (; x < end; x += sizeof(std::uint64_t)) {
    std::uint64_t eight;
    std::memcpy(&eight, marks.data() + x, sizeof eight);
    if (eight != 0) break;
  }
  while (x < end && !marks[x]) ++x;
  return x;
}

}  // namespace

/// Local maxima of the rows from `first_center` up to `end_center`, in reading order.
std::vector<Corner> findMaxima(const Image& image, int first_center, int end_center, double min_score) {
  const int width = image.width();
  std::vector<Corner> maxima;
  constexpr double kMomentScale = Gradients::kScale * Gradients::kScale * kWindowPixels;
  const auto threshold = static_cast<float>(min_score * min_score * kMomentScale);
  Gradients gradients(image);
  ColumnMoments moments(width);
  RowRing<float> response(2 * kMinDistance_px + 1, width);
  std::vector<std::uint8_t> marks(width + sizeof(std::uint64_t), 0);
  const int first_row = first_center - kMinDistance_px, end_row = end_center + kMinDistance_px;
  for (int y = first_row - kHalfWindow_px; y < first_row + kHalfWindow_px; ++y)
    gradients.advanceTo(y), moments.slideTo(gradients, y);
  for (int y = first_row; y < end_row; ++y) {
    gradients.advanceTo(y + kHalfWindow_px);
    moments.slideTo(gradients, y + kHalfWindow_px);
    smallerEigenvalues(moments, kBorder_px - kMinDistance_px, width - kBorder_px + kMinDistance_px, response.row(y));
    const int center = y - kMinDistance_px;
    if (center < first_center) continue;
    markPeaks(response, center, kBorder_px, width - kBorder_px, threshold, marks.data());
    for (int x = kBorder_px; x < width - kBorder_px; ++x) {
      x = nextMark(marks, x);
      if (x >= width - kBorder_px || !isMaximum(response, x, center)) continue;
      const auto score = static_cast<float>(std::sqrt(response.row(center)[x] / kMomentScale));
      if (score < kMinScoreOverGrain * grainAround(image, x, center)) continue;
      maxima.push_back({static_cast<float>(x), static_cast<float>(center), score});
    }
  }
  return maxima;
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {
namespace {

MOTORCADE_EXPORT(findMaxima);

constexpr int kCell_px = CornerDetector::kCell_px, kMaxPerCell = 6, kBorder_px = HWY_NAMESPACE::kBorder_px;

struct Candidate {
  int cell;
  Corner corner;
};

bool strongerInCell(const Candidate& a, const Candidate& b) {
  return std::tuple(a.cell, -a.corner.score, a.corner.v_px, a.corner.u_px) <
         std::tuple(b.cell, -b.corner.score, b.corner.v_px, b.corner.u_px);
}

/// Local maxima of the whole image, in reading order. Bands of rows are searched in parallel, one for each thread, as
/// each takes some rows of those beside it too.
std::vector<Candidate> findCandidates(const Image& image, double min_score) {
  constexpr int kMaxBands = 4;
  const int count = std::clamp(threadsForItems(), 1, kMaxBands);
  const int rows = image.height() - 2 * kBorder_px;
  if (rows <= 0 || image.width() <= 2 * kBorder_px) return {};
  const auto startOf = [&](std::size_t band) { return kBorder_px + rows * static_cast<int>(band) / count; };
  std::vector<std::vector<Corner>> bands(count);
  const auto find = MOTORCADE_KERNEL(findMaxima);
  forEachItem(
      bands.size(), [&](std::size_t i) { bands[i] = find(image, startOf(i), startOf(i + 1), min_score); }, 1);
  const int columns = (image.width() + kCell_px - 1) / kCell_px;
  std::vector<Candidate> candidates;
  for (const auto& band : bands)
    for (const Corner& corner : band) {
      const int column = static_cast<int>(corner.u_px) / kCell_px, row = static_cast<int>(corner.v_px) / kCell_px;
      candidates.push_back({row * columns + column, corner});
    }
  return candidates;
}

/// The score that corners of a rank must exceed, so that at most `room` of them pass.
float cutOfRank(const std::vector<std::pair<int, Candidate>>& ranked, int rank, int room) {
  std::vector<float> scores;
  for (const auto& [r, candidate] : ranked)
    if (r == rank) scores.push_back(candidate.corner.score);
  std::ranges::nth_element(scores, scores.begin() + room, std::greater{});
  return scores[room];
}

}  // namespace

CornerDetector::CornerDetector(const Params& params) : params_(requireValid(params)) {}

std::vector<Corner> CornerDetector::operator()(const Image& image, double score_share, const PixelMask* ignored) const {
  std::vector<Candidate> candidates = findCandidates(image, score_share * params_.min_score);
  if (ignored)
    std::erase_if(candidates, [&](const Candidate& c) { return ignored->holds(c.corner.u_px, c.corner.v_px); });
  std::ranges::sort(candidates, strongerInCell);

  std::vector<std::pair<int, Candidate>> ranked;  // with the rank in the cell
  std::vector<int> of_rank(kMaxPerCell);
  for (int i = 0, rank = 0; i < static_cast<int>(candidates.size()); ++i) {
    rank = i > 0 && candidates[i - 1].cell == candidates[i].cell ? rank + 1 : 0;
    if (rank >= kMaxPerCell) continue;
    ranked.emplace_back(rank, candidates[i]);
    ++of_rank[rank];
  }

  int last_rank = 0, room = params_.max_corners;
  while (last_rank < kMaxPerCell && of_rank[last_rank] <= room) room -= of_rank[last_rank++];
  const float cut = last_rank < kMaxPerCell ? cutOfRank(ranked, last_rank, room) : 0;
  std::vector<Corner> corners;
  corners.reserve(params_.max_corners);
  for (const auto& [rank, candidate] : ranked)
    if (rank < last_rank || (rank == last_rank && candidate.corner.score > cut)) corners.push_back(candidate.corner);
  return corners;
}

std::vector<Parameter> parametersOf(CornerDetector::Params& params) {
  return {numberParameter("max_corners", params.max_corners, {100, 20000},
                          "more corners: more points to follow, at more cost"),
          numberParameter("min_score", params.min_score, {0.1, 5},
                          "lower finds corners in dim or blurred images, higher ignores noise")};
}

}  // namespace motorcade
#endif
