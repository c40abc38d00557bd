#include "frontend/image/region_template.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>

namespace motorcade {
namespace {

/// Brightness between four pixels, of which (x, y) is the upper left.
float interpolated(const Image& image, int x, int y, float share_x, float share_y) {
  const std::uint8_t *upper = image.row(y) + x, *lower = image.row(y + 1) + x;
  const float above = static_cast<float>(upper[0]) + share_x * static_cast<float>(upper[1] - upper[0]);
  const float below = static_cast<float>(lower[0]) + share_x * static_cast<float>(lower[1] - lower[0]);
  return above + share_y * (below - above);
}

float sample(const Image& image, double u_px, double v_px) {
  const double u = std::clamp(u_px, 0.0, image.width() - 1.001), v = std::clamp(v_px, 0.0, image.height() - 1.001);
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  return interpolated(image, x, y, static_cast<float>(u - x), static_cast<float>(v - y));
}

/// To zero mean and unit norm; false where all values are alike.
bool normalize(std::vector<float>& values) {
  constexpr float kLeastDeviation_gray = 2;
  float mean = 0, energy = 0;
  for (const float value : values) mean += value / static_cast<float>(values.size());
  for (float& value : values) value -= mean, energy += value * value;
  if (energy < kLeastDeviation_gray * kLeastDeviation_gray * static_cast<float>(values.size())) return false;
  for (float& value : values) value /= std::sqrt(energy);
  return true;
}

/// The quadratic through the scores around the greatest one: where it peaks, and its curvature there.
struct Peak {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  Eigen::Matrix2d curvature;  // minus the second derivatives

  /// `score(x, y)` of -1, 0 and 1. A coordinate that is held stays 0.
  template <class Score>
  Peak(const Score& score, bool holds_u, bool holds_v) {
    constexpr double kLeast = 1e-6;
    const double best = score(0, 0), left = score(-1, 0), right = score(1, 0), above = score(0, -1),
                 below = score(0, 1);
    const double cross = holds_u || holds_v ? 0 : (score(1, 1) - score(1, -1) - score(-1, 1) + score(-1, -1)) / 4;
    curvature << std::max(kLeast, 2 * best - left - right), -cross, -cross, std::max(kLeast, 2 * best - above - below);
    const Eigen::Vector2d slope(holds_u ? 0 : (right - left) / 2, holds_v ? 0 : (below - above) / 2);
    if (curvature.determinant() <= kLeast * kLeast) curvature = Eigen::Matrix2d(curvature.diagonal().asDiagonal());
    at = (curvature.inverse() * slope).cwiseMax(-1).cwiseMin(1);
  }
};

/// Correlation of normalized values with those of `sampled(i)`.
template <class Sample>
double correlation(const std::vector<float>& values, const Sample& sampled) {
  float sum = 0, energy = 0, product = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const float value = sampled(i);
    sum += value, energy += value * value, product += value * values[i];
  }
  if (values.empty()) return 0;
  const float variance = energy - sum * sum / static_cast<float>(values.size());
  return variance > 1 ? product / std::sqrt(variance) : 0;
}

/// A template's pixels around a place of an image. A shift by whole pixels leaves the weights of their neighbors.
class ShiftedPixels {
 public:
  ShiftedPixels(const Image& image, const Eigen::Vector2d& middle_px, const std::vector<Eigen::Vector2f>& offsets_px,
                double scale)
      : image_(image), last_x_(image.width() - 2), last_y_(image.height() - 2) {
    for (const Eigen::Vector2f& offset : offsets_px) {
      const Eigen::Vector2d at_px = middle_px + scale * offset.cast<double>(), first_px = at_px.array().floor();
      const Eigen::Vector2f share = (at_px - first_px).cast<float>();
      pixels_.push_back({static_cast<int>(first_px.x()), static_cast<int>(first_px.y()), share.x(), share.y()});
    }
  }

  float operator()(std::size_t i, int right_px, int down_px) const {
    const Pixel& pixel = pixels_[i];
    const int x = std::clamp(pixel.x + right_px, 0, last_x_), y = std::clamp(pixel.y + down_px, 0, last_y_);
    return interpolated(image_, x, y, pixel.share_x, pixel.share_y);
  }

 private:
  struct Pixel {
    int x, y;  // upper left of the four neighbors
    float share_x, share_y;
  };

  const Image& image_;
  int last_x_, last_y_;
  std::vector<Pixel> pixels_;
};

}  // namespace

RegionTemplate::RegionTemplate(const Image& image, const Eigen::Vector2d& middle_px,
                               std::vector<Eigen::Vector2f> offsets_px, double scale)
    : offsets_px_(std::move(offsets_px)) {
  for (const Eigen::Vector2f& offset : offsets_px_)
    values_.push_back(sample(image, middle_px.x() + scale * offset.x(), middle_px.y() + scale * offset.y()));
  if (!normalize(values_)) values_.clear();
}

double RegionTemplate::ncc(const Image& image, const Eigen::Vector2d& middle_px, double scale) const {
  return correlation(values_, [&](std::size_t i) {
    return sample(image, middle_px.x() + scale * offsets_px_[i].x(), middle_px.y() + scale * offsets_px_[i].y());
  });
}

std::optional<RegionTemplate::Match> RegionTemplate::find(const Image& image, const Eigen::Vector2d& guess_px,
                                                          double scale, const Eigen::Vector2i& radius_px) const {
  // Neighboring pixels and what bends and swings leave fewer independent ones than there are.
  constexpr double kDependentPixels = 9;
  constexpr double kLeastUnexplained = 0.01;  // of the correlation: sampling between pixels leaves as much
  constexpr int kPeak_px = 3;                 // from the best match, which scores high there as well
  if (values_.empty()) return std::nullopt;
  const ShiftedPixels shifted(image, guess_px, offsets_px_, scale);
  const auto at = [&](int x, int y) { return correlation(values_, [&](std::size_t i) { return shifted(i, x, y); }); };
  Match match;
  int u = 0, v = 0;
  std::vector<double> scores;
  for (int y = -radius_px.y(); y <= radius_px.y(); ++y)
    for (int x = -radius_px.x(); x <= radius_px.x(); ++x) {
      scores.push_back(at(x, y));
      if (scores.back() > match.ncc) match.ncc = scores.back(), u = x, v = y;
    }
  double elsewhere = 0;
  for (int y = -radius_px.y(), i = 0; y <= radius_px.y(); ++y)
    for (int x = -radius_px.x(); x <= radius_px.x(); ++x, ++i)
      if (std::abs(x - u) > kPeak_px || std::abs(y - v) > kPeak_px) elsewhere = std::max(elsewhere, scores[i]);
  const double independent = static_cast<double>(values_.size()) / kDependentPixels;
  const double unexplained = std::max(kLeastUnexplained, 1 - match.ncc);
  if (match.ncc - elsewhere < unexplained * (1 + match.ncc) / std::sqrt(independent)) return std::nullopt;
  const bool at_edge =
      (radius_px.x() > 0 && std::abs(u) == radius_px.x()) || (radius_px.y() > 0 && std::abs(v) == radius_px.y());
  if (match.ncc <= 0 || at_edge) return std::nullopt;
  const bool holds_u = radius_px.x() == 0, holds_v = radius_px.y() == 0;
  const Peak peak([&](int x, int y) { return at(u + x, v + y); }, holds_u, holds_v);
  match.middle_px = guess_px + Eigen::Vector2d(u, v) + peak.at;
  match.sigma_px = (2 * unexplained / independent * peak.curvature.inverse()).diagonal().cwiseSqrt();
  return match;
}

}  // namespace motorcade
