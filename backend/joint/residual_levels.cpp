#include "backend/joint/residual_levels.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace motorcade {
namespace {

constexpr int kColumns = 12, kRows = 5;  // of cells

std::size_t cellOf(const StereoCamera& camera, const Eigen::Vector3d& uvd_px) {
  const auto place = [](double share, int cells) { return std::clamp(static_cast<int>(share * cells), 0, cells - 1); };
  return kColumns * place(uvd_px.y() / camera.height_px, kRows) + place(uvd_px.x() / camera.width_px, kColumns);
}

/// Sums of vectors by cell of the image, over all frames, so that each meets those of the other landmarks in its cell.
template <int N>
class CellSums {
 public:
  using Vector = Eigen::Matrix<double, N, 1>;

  /// Adds the `value` of each view of a landmark.
  template <class ValueOf>
  void add(const StereoCamera& camera, std::span<const LandmarkView> views, const ValueOf& value) {
    for (std::size_t i = 0; i < views.size();) {
      const std::size_t cell = cellOf(camera, views[i].uvd_px);
      Vector own = Vector::Zero();
      for (; i < views.size() && cellOf(camera, views[i].uvd_px) == cell; ++i) own += value(i);
      sums_[cell] += own;
      own_squares_ += own.squaredNorm();
    }
  }
  /// Sum of the products of each vector with those of other landmarks in its cell.
  double productsWithOthers() const {
    double squares = 0;
    for (const Vector& sum : sums_) squares += sum.squaredNorm();
    return squares - own_squares_;
  }

 private:
  std::vector<Vector> sums_ = std::vector<Vector>(kColumns * kRows, Vector::Zero());
  double own_squares_ = 0;
};

using CellCounts = CellSums<1>;

void count(const StereoCamera& camera, std::span<const LandmarkView> views, CellCounts& counts) {
  counts.add(camera, views, [](std::size_t) { return CellCounts::Vector::Ones(); });
}

void addLevels(const LandmarkFit& fit, ResidualLevels& levels) {
  const auto linear = fit.views();
  const double squared = 1 / fit.informationShare();  // residuals of full weight
  for (const LinearView& l : linear) {
    levels.uv_sum += squared * l.r().head<2>().squaredNorm();
    levels.d_sum += squared * l.r().z() * l.r().z();
  }
  for (std::size_t i = 1; i < linear.size(); ++i)
    levels.successive_sum += squared * linear[i - 1].r().dot(linear[i].r());
  levels.uv_count += 2.0 * static_cast<double>(linear.size() - 1);
  levels.d_count += static_cast<double>(linear.size() - 1);
  levels.views += static_cast<double>(linear.size());
}

}  // namespace

ResidualLevels residualLevels(const StereoCamera& camera, const LandmarkNoise& noise, const LandmarkViews& landmarks,
                              FramePose pose, std::span<const SE3> T_cam_body, double offset_px) {
  ResidualLevels levels;
  LandmarkFit fit(camera, noise, pose, T_cam_body, offset_px);
  CellSums<3> sums;
  CellCounts counts;
  for (int j = 0; j < landmarks.count(); ++j) {
    if (!fit(landmarks.of(j), landmarks.before.empty() ? std::nullopt : landmarks.before[j])) continue;
    addLevels(fit, levels);
    const double full = 1 / std::sqrt(fit.informationShare());
    sums.add(camera, landmarks.of(j), [&](std::size_t i) { return full * fit.views()[i].r(); });
    count(camera, landmarks.of(j), counts);
  }
  levels.neighbor_sum = sums.productsWithOthers();
  levels.neighbor_count = counts.productsWithOthers();
  return levels;
}

double neighborsPerView(const StereoCamera& camera, const LandmarkViews& landmarks) {
  CellCounts counts;
  for (int j = 0; j < landmarks.count(); ++j) count(camera, landmarks.of(j), counts);
  return counts.productsWithOthers() / static_cast<double>(landmarks.views.size());
}

}  // namespace motorcade
