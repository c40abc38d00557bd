#include "apps/inject/image_faults.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "io/images/image_file.hpp"

namespace motorcade {
namespace {

std::uint8_t toGray(double value) { return static_cast<std::uint8_t>(std::clamp(std::lround(value), 0L, 255L)); }

/// Makes a new image; a function of the position gives each pixel.
template <class Gray>
Image imageOf(const Image& like, ImagePool& pool, const Gray& gray) {
  Image image = pool.acquire(like.width(), like.height());
  for (int y = 0; y < image.height(); ++y) {
    std::uint8_t* const row = image.mutableRow(y);
    for (int x = 0; x < image.width(); ++x) row[x] = gray(x, y);
  }
  return image;
}

/// Means of `2 reach + 1` values, the ends being repeated.
std::vector<double> runningMeans(const std::vector<double>& values, int reach) {
  const int last = static_cast<int>(values.size()) - 1;
  const auto at = [&](int i) { return values[static_cast<std::size_t>(std::clamp(i, 0, last))]; };
  std::vector<double> means;
  means.reserve(values.size());
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) sum += at(i);
  for (int i = 0; i <= last; ++i) {
    means.push_back(sum / (2 * reach + 1));
    sum += at(i + reach + 1) - at(i - reach);
  }
  return means;
}

/// Gray level between the pixels; pixels of the border are repeated.
double sampled(const Image& image, double x, double y) {
  x = std::clamp(x, 0.0, image.width() - 1.0);
  y = std::clamp(y, 0.0, image.height() - 1.0);
  const int left = std::min(static_cast<int>(x), image.width() - 2),
            top = std::min(static_cast<int>(y), image.height() - 2);
  const double u = x - left, v = y - top;
  return (1 - v) * ((1 - u) * image.at(left, top) + u * image.at(left + 1, top)) +
         v * ((1 - u) * image.at(left, top + 1) + u * image.at(left + 1, top + 1));
}

/// Warps an image; `source(x, y)`, relative to the middle, is the source position of each pixel.
template <class Source>
Image moved(const Image& image, ImagePool& pool, const Source& source) {
  const double middle_x = (image.width() - 1) / 2.0, middle_y = (image.height() - 1) / 2.0;
  return imageOf(image, pool, [&](int x, int y) {
    const auto [from_x, from_y] = source(x - middle_x, y - middle_y);
    return toGray(sampled(image, middle_x + from_x, middle_y + from_y));
  });
}

}  // namespace

Image filled(const Image& like, std::uint8_t gray, ImagePool& pool) {
  return imageOf(like, pool, [gray](int, int) { return gray; });
}

Image blurred(const Image& image, double width_px, ImagePool& pool) {
  const int reach = static_cast<int>(width_px / 2);
  std::vector<std::vector<double>> rows;
  for (int y = 0; y < image.height(); ++y)
    rows.push_back(runningMeans({image.row(y), image.row(y) + image.width()}, reach));
  std::vector<double> column(static_cast<std::size_t>(image.height()));
  for (int x = 0; x < image.width(); ++x) {
    for (std::size_t y = 0; y < column.size(); ++y) column[y] = rows[y][static_cast<std::size_t>(x)];
    column = runningMeans(column, reach);
    for (std::size_t y = 0; y < column.size(); ++y) rows[y][static_cast<std::size_t>(x)] = column[y];
  }
  return imageOf(image, pool,
                 [&](int x, int y) { return toGray(rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)]); });
}

Image withNoise(const Image& image, double sigma_gray, std::uint64_t seed, ImagePool& pool) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0, 1);
  return imageOf(image, pool, [&](int x, int y) { return toGray(image.at(x, y) + sigma_gray * noise(random)); });
}

Image exposed(const Image& image, double factor, ImagePool& pool) {
  return imageOf(image, pool, [&](int x, int y) { return toGray(factor * image.at(x, y)); });
}

Image throughJpeg(const Image& image, int quality, ImagePool& pool) {
  return decodeImage(encodeJpeg(image, quality), "compressed", pool);
}

Image lowered(const Image& image, double rows_px, ImagePool& pool) {
  return moved(image, pool, [rows_px](double x, double y) { return std::pair(x, y - rows_px); });
}

Image rolled(const Image& image, double angle_rad, ImagePool& pool) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return moved(image, pool, [c, s](double x, double y) { return std::pair(c * x + s * y, c * y - s * x); });
}

Image zoomed(const Image& image, double factor, ImagePool& pool) {
  return moved(image, pool, [factor](double x, double y) { return std::pair(x / factor, y / factor); });
}

Image distorted(const Image& image, double k1, ImagePool& pool) {
  const double unit_px = image.width() / 2.0;
  return moved(image, pool, [k1, unit_px](double x, double y) {
    constexpr int kIterations = 8;  // of the inverse, which converges for |k1| up to a half
    double shrink = 1;
    for (int i = 0; i < kIterations; ++i) {
      const double r2 = (x * x + y * y) * shrink * shrink / (unit_px * unit_px);
      shrink = 1 / (1 + k1 * r2);
    }
    return std::pair(x * shrink, y * shrink);
  });
}

std::string withBitFlips(std::string bytes, int count, std::uint64_t seed) {
  constexpr unsigned kBits = 8;
  if (bytes.empty()) return bytes;
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::size_t> bit(0, kBits * bytes.size() - 1);
  for (int i = 0; i < count; ++i) {
    const std::size_t at = bit(random);
    bytes[at / kBits] = static_cast<char>(static_cast<unsigned char>(bytes[at / kBits]) ^ (1U << at % kBits));
  }
  return bytes;
}

}  // namespace motorcade
