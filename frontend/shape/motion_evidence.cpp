#include "frontend/shape/motion_evidence.hpp"

#include <cmath>
#include <cstdlib>

namespace motorcade {
namespace {

constexpr double kLeastShift = 1.5;  // cells between where the body's motion and rest take a point

/// Mean difference in gray levels of the 3x3 pixels around two places; empty where one is outside its image.
std::optional<float> differenceOf(const Image& now, int u, int v, const Image& before, const Eigen::Vector2d& at) {
  const int x = static_cast<int>(std::lround(at.x())), y = static_cast<int>(std::lround(at.y()));
  const auto inside = [](const Image& image, int column, int row) {
    return column >= 1 && row >= 1 && column + 1 < image.width() && row + 1 < image.height();
  };
  if (!inside(now, u, v) || !inside(before, x, y)) return std::nullopt;
  int sum = 0;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) sum += std::abs(now.row(v + dy)[u + dx] - before.row(y + dy)[x + dx]);
  return static_cast<float>(sum) / 9;
}

}  // namespace

float MotionEvidence::operator()(int column, int row) const {
  const double d = *disparities_.disparity_px(column, row) + view_.disparity_offset_px;
  const Eigen::Vector3d p_cam = camera_.triangulate({disparities_.u_px(column), disparities_.v_px(row), d});
  const auto moved = camera_.project(T_before_moved_ * p_cam),
             rested = camera_.project(view_.before->T_before_cam * p_cam);
  if (!moved || !rested) return 0;
  const double least_px = kLeastShift * (1 << disparities_.level);
  if ((*moved - *rested).head<2>().squaredNorm() < least_px * least_px) return 0;
  const auto as_moved = difference(column, row, *moved), as_rested = difference(column, row, *rested);
  return as_moved && as_rested ? *as_moved - *as_rested : 0;
}

std::optional<float> MotionEvidence::difference(int column, int row, const Eigen::Vector3d& before_uvd_px) const {
  const int level = disparities_.level;
  const double scale = 1 << level;
  const Eigen::Vector2d at((before_uvd_px.x() + 0.5) / scale - 0.5, (before_uvd_px.y() + 0.5) / scale - 0.5);
  const int u = disparities_.map.window.u0 + column, v = disparities_.map.window.v0 + row;
  return differenceOf(view_.before->now->levels[level], u, v, view_.before->before->levels[level], at);
}

}  // namespace motorcade
