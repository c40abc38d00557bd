#include "io/rig/lens_camera.hpp"

#include <cmath>
#include <numbers>

#include "core/elementary.hpp"

namespace motorcade {

LensModel::LensModel(const LensCamera& camera)
    : camera_(camera),
      rational_(camera.coefficients[5] != 0 || camera.coefficients[6] != 0 || camera.coefficients[7] != 0),
      limit_(limit()) {}

/// OpenCV's models: the rational one of Heikkilae and Silven (1997), extended, and that of Kannala and Brandt (2006).
double LensModel::factor(double squared) const {
  const auto& k = camera_.coefficients;
  switch (camera_.distortion) {
    case Distortion::kRadialTangential: {
      const double numerator = 1 + squared * (k[0] + squared * (k[1] + squared * k[4]));
      return rational_ ? numerator / (1 + squared * (k[5] + squared * (k[6] + squared * k[7]))) : numerator;
    }
    case Distortion::kEquidistant:
      return 1 + squared * (k[0] + squared * (k[1] + squared * (k[2] + squared * k[3])));
    case Distortion::kNone:
      break;
  }
  return 1;
}

Eigen::Vector2d LensModel::tangential(const Eigen::Vector2d& point) const {
  if (camera_.distortion != Distortion::kRadialTangential) return Eigen::Vector2d::Zero();
  const double p1 = camera_.coefficients[2], p2 = camera_.coefficients[3];
  const double x = point.x(), y = point.y(), squared = x * x + y * y;
  return {2 * p1 * x * y + p2 * (squared + 2 * x * x), p1 * (squared + 2 * y * y) + 2 * p2 * x * y};
}

double LensModel::limit() const {
  constexpr double kMostTangent = 20;  // 87 degrees
  constexpr int kSteps = 4000;
  const double most = camera_.distortion == Distortion::kEquidistant ? std::numbers::pi : kMostTangent;
  double reached = 0;
  for (int i = 1; i <= kSteps; ++i) {
    const double next = distorted(most * i / kSteps);
    if (!(next > reached)) return most * (i - 1) / kSteps;
    reached = next;
  }
  return most;
}

std::optional<double> LensModel::undistorted(double distorted_distance) const {
  constexpr int kHalvings = 52;  // to the last bit
  if (distorted_distance > distorted(limit_)) return std::nullopt;
  double low = 0, high = limit_;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (distorted(middle) < distorted_distance ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

std::optional<Eigen::Vector2d> LensModel::project(const Eigen::Vector3d& ray) const {
  const double across_squared = ray.x() * ray.x() + ray.y() * ray.y();
  double x = 0, y = 0;
  if (camera_.distortion == Distortion::kEquidistant) {
    const double across = std::sqrt(across_squared), angle_rad = arcTangent(across, ray.z());
    if (angle_rad > limit_) return std::nullopt;
    const double scale = across > 0 ? distorted(angle_rad) / across : 0;
    x = scale * ray.x();
    y = scale * ray.y();
  } else {
    if (!(ray.z() > 0)) return std::nullopt;
    const double inverse = 1 / ray.z(), squared = across_squared * inverse * inverse;
    if (squared > limit_ * limit_) return std::nullopt;
    const Eigen::Vector2d point(inverse * ray.x(), inverse * ray.y()), aside = tangential(point);
    const double scale = factor(squared);
    x = scale * point.x() + aside.x();
    y = scale * point.y() + aside.y();
  }
  const Eigen::Vector2d pixel_px(camera_.fx_px * x + camera_.cx_px, camera_.fy_px * y + camera_.cy_px);
  return std::isfinite(pixel_px.x()) && std::isfinite(pixel_px.y()) ? std::optional(pixel_px) : std::nullopt;
}

std::optional<Eigen::Vector3d> LensModel::rayThrough(const Eigen::Vector2d& pixel_px) const {
  constexpr int kRounds = 20;  // the tangential part is small: each round gains two digits and more
  constexpr double kConverged = 1e-15;
  const Eigen::Vector2d seen((pixel_px.x() - camera_.cx_px) / camera_.fx_px,
                             (pixel_px.y() - camera_.cy_px) / camera_.fy_px);
  Eigen::Vector2d point = Eigen::Vector2d::Zero();
  double distance = 0;
  for (int i = 0; i < kRounds; ++i) {
    const Eigen::Vector2d radial = seen - tangential(point);
    const auto found = undistorted(radial.norm());
    if (!found) return std::nullopt;
    distance = *found;
    const double scale = radial.norm() > 0 ? distance / radial.norm() : 0;
    const double change = (scale * radial - point).norm();
    point = scale * radial;
    if (change < kConverged) break;
  }
  if (camera_.distortion != Distortion::kEquidistant) return Eigen::Vector3d(point.x(), point.y(), 1);
  const double scale = distance > 0 ? sine(distance) / distance : 1;
  return Eigen::Vector3d(scale * point.x(), scale * point.y(), cosine(distance));
}

}  // namespace motorcade
