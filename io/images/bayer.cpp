#include "io/images/bayer.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <vector>

namespace motorcade {
namespace {

constexpr std::array<std::string_view, 4> kNames = {"RGGB", "BGGR", "GRBG", "GBRG"};

/// Weights of the sums that a pixel and its neighbors make, in 1/1024 of the gray.
struct Weights {
  int self, beside, above, diagonal;  // of each pixel
};

/// The luma 77 R + 150 G + 29 B, in 1/256, with the bilinear means of the colors that a pixel does not have:
///   on a red one    R = self, G = (left + right + above + below) / 4, B = (the four diagonals) / 4
///   on a green one, in a row with reds, R = (left + right) / 2, B = (above + below) / 2
/// and so on, with red and blue exchanged. All weights are whole in 1/1024, so that the only rounding is that of the
/// sum: (sum + 512) >> 10, to the nearest.
constexpr int kRed = 77, kGreen = 150, kBlue = 29;
constexpr Weights kOnRed{4 * kRed, kGreen, kGreen, kBlue}, kOnBlue{4 * kBlue, kGreen, kGreen, kRed};
constexpr Weights kGreenByRed{4 * kGreen, 2 * kRed, 2 * kBlue, 0}, kGreenByBlue{4 * kGreen, 2 * kBlue, 2 * kRed, 0};

/// Weights of the even and the odd pixels of a row.
using RowWeights = std::array<Weights, 2>;

RowWeights weightsOf(BayerPattern pattern, bool odd_row) {
  const std::string_view filters = kNames[static_cast<std::size_t>(pattern)].substr(odd_row ? 2 : 0, 2);
  const bool red_row = filters.find('R') != std::string_view::npos;
  const Weights color = red_row ? kOnRed : kOnBlue, green = red_row ? kGreenByRed : kGreenByBlue;
  return filters[0] == 'G' ? RowWeights{green, color} : RowWeights{color, green};
}

struct Rows {
  const std::uint8_t *above, *row, *below;
};

std::uint8_t grayAt(const Rows& rows, int left, int x, int right, const Weights& weights) {
  const int sum = weights.self * rows.row[x] + weights.beside * (rows.row[left] + rows.row[right]) +
                  weights.above * (rows.above[x] + rows.below[x]) +
                  weights.diagonal * (rows.above[left] + rows.above[right] + rows.below[left] + rows.below[right]);
  return static_cast<std::uint8_t>((sum + 512) >> 10);
}

/// Fills one row. The image is mirrored at the pixels of its edges, which keeps the filters' order.
void fillRow(const Rows& rows, const RowWeights& weights, int width, std::uint8_t* gray) {
  const int last = width - 1;
  gray[0] = grayAt(rows, 1, 0, 1, weights[0]);
  for (int x = 1; x < last; ++x) gray[x] = grayAt(rows, x - 1, x, x + 1, weights[x % 2]);
  gray[last] = grayAt(rows, last - 1, last, last - 1, weights[last % 2]);
}

/// Mean of each of the four places in the squares of two by two.
std::array<double, 4> meansOf(const Image& image) {
  std::array<std::int64_t, 4> sums{};
  const int width = image.width() / 2 * 2, height = image.height() / 2 * 2;
  for (int y = 0; y < height; ++y) {
    const std::uint8_t* row = image.row(y);
    std::int64_t even = 0, odd = 0;
    for (int x = 0; x < width; x += 2) even += row[x], odd += row[x + 1];
    sums[y % 2 * 2] += even;
    sums[y % 2 * 2 + 1] += odd;
  }
  std::array<double, 4> means{};
  const double count = 0.25 * width * height;
  for (std::size_t i = 0; i < 4; ++i) means[i] = static_cast<double>(sums[i]) / count;
  return means;
}

}  // namespace

std::string_view nameOf(BayerPattern pattern) { return kNames[static_cast<std::size_t>(pattern)]; }

std::optional<BayerPattern> bayerPatternOf(std::string_view name) {
  std::string text(name);
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  if (text.starts_with("BAYER_")) text = text.substr(6);
  if (text.ends_with("8") || text.ends_with("16")) text.resize(text.find_first_of("18"));
  const auto found = std::ranges::find(kNames, text);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<BayerPattern>(found - kNames.begin());
}

Image grayOfMosaic(const Image& mosaic, BayerPattern pattern, ImagePool& pool) {
  const int width = mosaic.width(), height = mosaic.height(), last = height - 1;
  assert(width > 1 && height > 1);
  Image gray = pool.acquire(width, height);
  for (int y = 0; y < height; ++y) {
    const Rows rows{mosaic.row(y == 0 ? 1 : y - 1), mosaic.row(y), mosaic.row(y == last ? last - 1 : y + 1)};
    fillRow(rows, weightsOf(pattern, y % 2 == 1), width, gray.mutableRow(y));
  }
  return gray;
}

/// Both greens of a mosaic see the same. Red and blue, on the other diagonal, differ from them or from each other. In
/// other images the means agree to a tenth of a level, or differ by whole rows or columns.
std::optional<std::string> suspectedMosaic(const Image& image) {
  constexpr double kLeast = 2, kMostOfGreens = 0.15;  // levels; share of that
  const auto means = meansOf(image);
  const double main_apart = std::abs(means[0] - means[3]), side_apart = std::abs(means[1] - means[2]);
  const double between = std::abs(means[0] + means[3] - means[1] - means[2]) / 2;
  const bool greens_beside = side_apart <= main_apart;
  const double greens_apart = std::min(main_apart, side_apart), apart = std::max({main_apart, side_apart, between});
  if (apart < kLeast || greens_apart > kMostOfGreens * apart) return std::nullopt;
  if (std::max(main_apart, side_apart) < kMostOfGreens * apart) return "RGGB, BGGR, GRBG or GBRG";
  return greens_beside ? "RGGB or BGGR" : "GRBG or GBRG";
}

}  // namespace motorcade
