#include "frontend/motion/window_correlation.hpp"

#include <algorithm>
#include <cmath>

namespace motorcade {
namespace {

constexpr int kSide = WindowPattern::kSide, kPixels = WindowPattern::kPixels;
constexpr float kMinTexture = 16;  // norm of a window, in gray levels: two levels at each pixel

}  // namespace

std::optional<WindowPattern> WindowPattern::sample(const Image& image, const Eigen::Vector2f& at_px, float scale) {
  const float step = 1 / scale, extent = (kSide - 1) * step;
  const float left = at_px.x() - 0.5F * extent + 0.5F, top = at_px.y() - 0.5F * extent + 0.5F;
  if (!(left >= 0 && top >= 0)) return std::nullopt;
  if (left + extent >= static_cast<float>(image.width()) || top + extent >= static_cast<float>(image.height()))
    return std::nullopt;
  std::array<float, kPixels> gray;
  float sum = 0;
  for (int j = 0, k = 0; j < kSide; ++j) {
    const std::uint8_t* const row = image.row(static_cast<int>(top + static_cast<float>(j) * step));
    for (int i = 0; i < kSide; ++i, ++k) sum += gray[k] = row[static_cast<int>(left + static_cast<float>(i) * step)];
  }
  float square = 0;
  for (float& v : gray) v -= sum / kPixels, square += v * v;
  const float norm = std::sqrt(square);
  if (norm < kMinTexture) return std::nullopt;
  WindowPattern pattern;
  for (int k = 0; k < kPixels; ++k) {
    pattern.values_[k] = static_cast<std::int16_t>(std::lround(kOne * gray[k] / norm));
    pattern.sum_ += pattern.values_[k];
  }
  return pattern;
}

CorrelatedImage::CorrelatedImage(const Image& image)
    : columns_(std::max(0, image.width() - kSide + 1)),
      rows_(std::max(0, image.height() - kSide + 1)),
      stride_(image.width()),
      pixels_(stride_ * image.height()),
      windows_(static_cast<std::size_t>(columns_) * rows_) {
  for (int y = 0; y < image.height(); ++y) std::copy_n(image.row(y), stride_, pixels_.begin() + y * stride_);
  for (int y = 0; y < rows_; ++y) {
    for (int x = 0; x < columns_; ++x) {
      int sum = 0, squares = 0;
      for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i) {
          const int pixel = pixels_[(y + j) * stride_ + x + i];
          sum += pixel, squares += pixel * pixel;
        }
      const float mean = static_cast<float>(sum) / kPixels;
      const float norm = std::sqrt(static_cast<float>(squares) - mean * static_cast<float>(sum));
      windows_[static_cast<std::size_t>(y) * columns_ + x] = {mean, norm < kMinTexture ? 0 : 1 / norm};
    }
  }
}

std::optional<float> CorrelatedImage::correlation(const WindowPattern& pattern, const Eigen::Vector2f& at_px) const {
  const Eigen::Vector2f first_px = at_px.array() - (0.5F * (kSide - 1) - 0.5F);
  if (!(first_px.x() >= 0 && first_px.y() >= 0)) return std::nullopt;
  if (first_px.x() >= static_cast<float>(columns_) || first_px.y() >= static_cast<float>(rows_)) return std::nullopt;
  const auto x = static_cast<std::size_t>(first_px.x()), y = static_cast<std::size_t>(first_px.y());
  const Window& window = windows_[y * columns_ + x];
  const std::int16_t* const a = pattern.values().data();
  const std::int16_t* const b = pixels_.data() + y * stride_ + x;
  int product = 0;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) product += a[j * kSide + i] * b[j * stride_ + i];
  const float less = static_cast<float>(pattern.sum()) * window.mean;
  return (static_cast<float>(product) - less) * window.inverse_norm / WindowPattern::kOne;
}

}  // namespace motorcade
