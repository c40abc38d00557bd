#include "frontend/corner_detector.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>

namespace motorcade {
namespace {

constexpr int kHalfWindow_px = 3;  // second moments are summed over 7x7 pixels
constexpr int kWindowPixels = (2 * kHalfWindow_px + 1) * (2 * kHalfWindow_px + 1);

/// Column sums of the products of gradients over the window's rows, which slide down the image.
struct ColumnMoments {
  std::vector<int> xx, xy, yy;
  explicit ColumnMoments(int width) : xx(width), xy(width), yy(width) {}

  /// Adds (sign +1) or takes away (sign -1) the products of row y. Central differences, so twice the gradient.
  void accumulate(const Image& image, int y, int sign) {
    const std::uint8_t* row = image.row(y);
    const std::uint8_t* above = image.row(y - 1);
    const std::uint8_t* below = image.row(y + 1);
    int* sum_xx = xx.data();
    int* sum_xy = xy.data();
    int* sum_yy = yy.data();
    for (int x = 1; x < image.width() - 1; ++x) {
      const int dx = row[x + 1] - row[x - 1], dy = below[x] - above[x];
      sum_xx[x] += sign * dx * dx;
      sum_xy[x] += sign * dx * dy;
      sum_yy[x] += sign * dy * dy;
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

/// The last rows of the response, by row number.
class RowRing {
 public:
  RowRing(int rows, int width) : rows_(rows), width_(width), values_(static_cast<std::size_t>(rows) * width) {}
  float* row(int y) { return values_.data() + static_cast<std::size_t>(y % rows_) * width_; }
  const float* row(int y) const { return values_.data() + static_cast<std::size_t>(y % rows_) * width_; }

 private:
  int rows_, width_;
  std::vector<float> values_;
};

/// True for the first of equal maxima in reading order.
bool isMaximumWithin(const RowRing& response, int x, int y, int radius) {
  const float value = response.row(y)[x];
  for (int dy = -radius; dy <= radius; ++dy) {
    const float* row = response.row(y + dy) + x;
    for (int dx = -radius; dx <= radius; ++dx) {
      const bool earlier = dy < 0 || (dy == 0 && dx < 0);
      if (row[dx] > value || (earlier && row[dx] == value)) return false;
    }
  }
  return true;
}

/// Marks pixels of row y above the threshold that no direct neighbour exceeds: a cheap filter, in vector code.
void markPeaks(const RowRing& response, int y, int first, int last, float threshold, std::uint8_t* marks) {
  const float *above = response.row(y - 1), *row = response.row(y), *below = response.row(y + 1);
  for (int x = first; x < last; ++x) {
    const float beside = std::max(row[x - 1], row[x + 1]);
    const float upper = std::max(std::max(above[x - 1], above[x]), above[x + 1]);
    const float lower = std::max(std::max(below[x - 1], below[x]), below[x + 1]);
    const float around = std::max(beside, std::max(upper, lower));
    marks[x] = static_cast<std::uint8_t>(row[x] >= std::max(around, threshold));
  }
}

struct Candidate {
  int cell;
  Corner corner;
};

bool strongerInCell(const Candidate& a, const Candidate& b) {
  return std::tuple(a.cell, -a.corner.score, a.corner.v_px, a.corner.u_px) <
         std::tuple(b.cell, -b.corner.score, b.corner.v_px, b.corner.u_px);
}

/// Local maxima of the whole image, in reading order.
std::vector<Candidate> findCandidates(const Image& image, const CornerDetector::Params& params) {
  const int width = image.width(), height = image.height(), radius = params.min_distance_px;
  const int border = std::max(params.border_px, kHalfWindow_px + 1 + radius);
  std::vector<Candidate> candidates;
  if (width <= 2 * border || height <= 2 * border) return candidates;

  const double moment_scale = 4.0 * kWindowPixels;  // central differences are twice the gradient
  const auto threshold = static_cast<float>(params.min_score * params.min_score * moment_scale);
  const int columns = (width + params.cell_px - 1) / params.cell_px;
  ColumnMoments moments(width);
  RowRing response(2 * radius + 1, width);
  std::vector<std::uint8_t> marks(width);
  const int first_row = border - radius, end_row = height - border + radius;
  for (int y = first_row - kHalfWindow_px; y < first_row + kHalfWindow_px; ++y) moments.accumulate(image, y, +1);
  for (int y = first_row; y < end_row; ++y) {
    moments.accumulate(image, y + kHalfWindow_px, +1);
    smallerEigenvalues(moments, border - radius, width - border + radius, response.row(y));
    moments.accumulate(image, y - kHalfWindow_px, -1);
    const int centre = y - radius;
    if (centre < border) continue;
    markPeaks(response, centre, border, width - border, threshold, marks.data());
    for (int x = border; x < width - border; ++x) {
      if (!marks[x] || !isMaximumWithin(response, x, centre, radius)) continue;
      const auto score = static_cast<float>(std::sqrt(response.row(centre)[x] / moment_scale));
      candidates.push_back(
          {centre / params.cell_px * columns + x / params.cell_px, {static_cast<float>(x), static_cast<float>(centre), score}});
    }
  }
  return candidates;
}

/// Lowest score that may pass in the last rank that still finds room.
float cutOfRank(const std::vector<std::pair<int, Candidate>>& ranked, int rank, int room) {
  std::vector<float> scores;
  for (const auto& [r, candidate] : ranked)
    if (r == rank) scores.push_back(candidate.corner.score);
  std::ranges::nth_element(scores, scores.begin() + room, std::greater{});
  return scores[room];
}

}  // namespace

CornerDetector::CornerDetector(const Params& params) : params_(params) {
  if (params.cell_px < 1 || params.max_corners < 0 || params.min_distance_px < 1 || params.min_score <= 0)
    throw std::invalid_argument("corner detector: cell_px, min_distance_px and min_score must be positive");
}

std::vector<Corner> CornerDetector::operator()(const Image& image) const {
  std::vector<Candidate> candidates = findCandidates(image, params_);
  std::ranges::sort(candidates, strongerInCell);

  std::vector<std::pair<int, Candidate>> ranked;  // with the rank in the cell
  std::vector<int> of_rank(static_cast<std::size_t>(params_.max_per_cell));
  for (int i = 0, rank = 0; i < static_cast<int>(candidates.size()); ++i) {
    rank = i > 0 && candidates[i - 1].cell == candidates[i].cell ? rank + 1 : 0;
    if (rank >= params_.max_per_cell) continue;
    ranked.emplace_back(rank, candidates[i]);
    ++of_rank[rank];
  }

  int last_rank = 0, room = params_.max_corners;
  while (last_rank < params_.max_per_cell && of_rank[last_rank] <= room) room -= of_rank[last_rank++];
  const float cut = last_rank < params_.max_per_cell ? cutOfRank(ranked, last_rank, room) : 0;
  std::vector<Corner> corners;
  corners.reserve(static_cast<std::size_t>(params_.max_corners));
  for (const auto& [rank, candidate] : ranked)
    if (rank < last_rank || (rank == last_rank && candidate.corner.score > cut)) corners.push_back(candidate.corner);
  return corners;
}

}  // namespace motorcade
