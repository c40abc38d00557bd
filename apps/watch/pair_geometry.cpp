#include "apps/watch/pair_geometry.hpp"

#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>

namespace motorcade {
namespace {

constexpr int kSize = static_cast<int>(kRowErrors);
using Row = Eigen::Matrix<double, 1, kSize>;
using Vector = Eigen::Matrix<double, kSize, 1>;
using Matrix = Eigen::Matrix<double, kSize, kSize>;

/// Prior sigmas of a rig, in the order of RowError: 20 px, 5 degrees, 10 %, 5 degrees, a fifth of the baseline, k1.
const Vector kPriorSigmas = (Vector() << 20, 0.09, 0.1, 0.09, 0.2, 0.2, 0.4).finished();
constexpr double kScale_px = 0.4;  // residuals well above lose their weight
constexpr double kAgreeing_px = 1.2;
constexpr int kIterations = 30;
/// Factor on the standard deviations. Matches of successive frames show the same points, so that their effective number
/// is smaller.
constexpr double kCorrelation = 3;

Row derivatives(const EpipolarMatch& match, const StereoCamera& camera) {
  const double f = camera.fx_px, d = match.disparity_px();
  const double x = (match.u_left_px - camera.cx_px) / f, y = (match.v_left_px - camera.cy_px) / f, x_r = x - d / f;
  Row row;
  row << 1 + y * y, f * x, f * y, f * x * y, d, y * d, f * y * (x_r * x_r - x * x);
  return row;
}

/// Effect of each error per unit on the rows, root mean square over the image; of kBarrel, the displacement in a
/// corner.
Vector reach(const StereoCamera& camera) {
  const double f = camera.fx_px, half_width = camera.width_px / (2 * f), half_height = camera.height_px / (2 * f);
  const double mean_x = half_width / std::numbers::sqrt3, mean_y = half_height / std::numbers::sqrt3;
  const double corner = std::hypot(half_width, half_height);
  constexpr double kUsual_px = 20;  // disparity of what is not far
  return (Vector() << 1, f * mean_x, f * mean_y, f * mean_x * mean_y, kUsual_px, kUsual_px * mean_y,
          f * corner * corner * corner)
      .finished();
}

}  // namespace

PairGeometry estimatePairGeometry(std::span<const EpipolarMatch> matches, const StereoCamera& camera) {
  Vector solution = Vector::Zero();
  Matrix covariance = kPriorSigmas.cwiseAbs2().asDiagonal();
  double scale_px = 8;  // wide at first, as errors may be of many pixels
  for (int i = 0; i < kIterations; ++i) {
    Matrix information = kPriorSigmas.cwiseAbs2().cwiseInverse().asDiagonal();
    Vector right_side = Vector::Zero();
    for (const EpipolarMatch& match : matches) {
      const Row row = derivatives(match, camera);
      const double residual_px = match.rowDifference_px() - row * solution;
      const double weight = 1 / (1 + std::pow(residual_px / scale_px, 2)) / (scale_px * scale_px);
      information += weight * row.transpose() * row;
      right_side += weight * match.rowDifference_px() * row.transpose();
    }
    covariance = information.ldlt().solve(Matrix::Identity());
    solution = covariance * right_side;
    scale_px = std::max(kScale_px, 0.8 * scale_px);
  }
  PairGeometry geometry;
  std::size_t agreeing = 0;
  double squares = 0, explained_squares = 0;
  for (const EpipolarMatch& match : matches) {
    const double explained_px = derivatives(match, camera) * solution;
    const double residual_px = match.rowDifference_px() - explained_px;
    if (std::abs(residual_px) > kAgreeing_px) continue;
    ++agreeing;
    squares += residual_px * residual_px;
    explained_squares += explained_px * explained_px;
  }
  const Vector reach_px = reach(camera);
  for (int k = 0; k < kSize; ++k)
    geometry.errors[static_cast<std::size_t>(k)] = {solution[k], kCorrelation * std::sqrt(covariance(k, k)),
                                                    std::abs(solution[k]) * reach_px[k]};
  geometry.matches = matches.size();
  geometry.rms_px = rowRms_px(matches);
  geometry.remaining_px = std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, agreeing)));
  geometry.explained_px = std::sqrt(explained_squares / static_cast<double>(std::max<std::size_t>(1, agreeing)));
  geometry.agreeing_share =
      static_cast<double>(agreeing) / static_cast<double>(std::max<std::size_t>(1, matches.size()));
  return geometry;
}

double rowRms_px(std::span<const EpipolarMatch> matches) {
  double squares = 0;
  for (const EpipolarMatch& match : matches) squares += match.rowDifference_px() * match.rowDifference_px();
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, matches.size())));
}

double predictedRowError_px(const PairGeometry& geometry, const StereoCamera& camera, double u_left_px,
                            double v_left_px, double disparity_px) {
  const Row row = derivatives({u_left_px, v_left_px, u_left_px - disparity_px, v_left_px}, camera);
  double error_px = 0;
  for (int k = 0; k < kSize; ++k) error_px += row[k] * geometry.errors[static_cast<std::size_t>(k)].value;
  return error_px;
}

std::size_t matchesInRow(std::span<const EpipolarMatch> matches) {
  std::vector<double> differences;
  differences.reserve(matches.size());
  for (const EpipolarMatch& match : matches) differences.push_back(match.rowDifference_px());
  const double middle = median(differences);
  return static_cast<std::size_t>(std::ranges::count_if(
      differences, [middle](double difference_px) { return std::abs(difference_px - middle) < 1; }));
}

}  // namespace motorcade
