#include "frontend/image/region_template.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace motorcade {
namespace {

float sample(const Image& image, double u_px, double v_px) {
  const double u = std::clamp(u_px, 0.0, image.width() - 1.001), v = std::clamp(v_px, 0.0, image.height() - 1.001);
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  const auto fx = static_cast<float>(u - x), fy = static_cast<float>(v - y);
  const std::uint8_t *upper = image.row(y) + x, *lower = image.row(y + 1) + x;
  const float above = static_cast<float>(upper[0]) + fx * static_cast<float>(upper[1] - upper[0]);
  const float below = static_cast<float>(lower[0]) + fx * static_cast<float>(lower[1] - lower[0]);
  return above + fy * (below - above);
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

/// A parabola through the scores at -1, 0 and 1, of which the middle one is the greatest.
struct Peak {
  double at, curvature;
  Peak(double before, double best, double after) : at(0), curvature(std::max(1e-6, 2 * best - before - after)) {
    at = 0.5 * (after - before) / curvature;
  }
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
  float sum = 0, energy = 0, product = 0;
  for (std::size_t i = 0; i < values_.size(); ++i) {
    const float value =
        sample(image, middle_px.x() + scale * offsets_px_[i].x(), middle_px.y() + scale * offsets_px_[i].y());
    sum += value, energy += value * value, product += value * values_[i];
  }
  const float variance = energy - sum * sum / static_cast<float>(values_.size());
  return variance > 1 ? product / std::sqrt(variance) : 0;
}

std::optional<RegionTemplate::Match> RegionTemplate::find(const Image& image, const Eigen::Vector2d& guess_px,
                                                          double scale, const Eigen::Vector2i& radius_px) const {
  // Neighboring pixels and what bends and swings leave fewer independent ones than there are.
  constexpr double kDependentPixels = 9;
  constexpr int kPeak_px = 3;  // from the best match, which scores high there as well
  if (values_.empty()) return std::nullopt;
  const auto at = [&](int x, int y) { return ncc(image, guess_px + Eigen::Vector2d(x, y), scale); };
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
  if (match.ncc - elsewhere < (1 - match.ncc * match.ncc) / std::sqrt(independent)) return std::nullopt;
  const bool at_edge =
      (radius_px.x() > 0 && std::abs(u) == radius_px.x()) || (radius_px.y() > 0 && std::abs(v) == radius_px.y());
  if (match.ncc <= 0 || at_edge) return std::nullopt;
  const Peak across(at(u - 1, v), match.ncc, at(u + 1, v)), down(at(u, v - 1), match.ncc, at(u, v + 1));
  match.middle_px = guess_px + Eigen::Vector2d(u, v) +
                    Eigen::Vector2d(radius_px.x() > 0 ? across.at : 0, radius_px.y() > 0 ? down.at : 0);
  const double noise = 2 * (1 - match.ncc) * kDependentPixels / static_cast<double>(values_.size());
  match.sigma_px = {std::sqrt(noise / across.curvature), std::sqrt(noise / down.curvature)};
  return match;
}

}  // namespace motorcade
