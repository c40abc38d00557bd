#include "backend/joint/landmark_elimination.hpp"

#include <algorithm>
#include <numeric>

#include <Eigen/Cholesky>

#include "backend/elimination/dense_kernels.hpp"
#include "core/instruction_set.hpp"

#define HWY_TARGET_INCLUDE "backend/joint/landmark_elimination.cpp"
#include <hwy/foreach_target.h>

#include "backend/joint/row_products.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {
namespace {

constexpr int kLandmark = 4;               // unknowns of a landmark
constexpr int kRest = 2;                   // columns of the offset and of the right-hand side
constexpr int kPose = 6, kShakenPose = 7;  // rows of a frame: the steps of its pose, and its shake

using Matrix8d = Eigen::Matrix<double, 6 + kRest, 6 + kRest>;
using Matrix84d = Eigen::Matrix<double, 6 + kRest, kLandmark>;
using Matrix24d = Eigen::Matrix<double, kRest, kLandmark>;

/// Sums up the system that the elimination of landmarks leaves. They come in the order of their first frames: several
/// are subtracted at a time, from the first's first frame on.
class LandmarkSum {
 public:
  LandmarkSum(int frames, bool shaken)
      : own_(frames, Matrix8d::Zero()),
        rows_(shaken ? kShakenPose : kPose),
        size_(rows_ * frames + kRest),
        stride_(padded(size_)),
        Y_(std::size_t(stride_) * kColumns, 0.0),
        system_(std::size_t(stride_) * size_, 0.0) {}

  void add(std::span<const LandmarkView> views, const LandmarkFit& fit) {
    if (columns_ == kColumns) subtract();
    if (columns_ == 0) first_row_ = rows_ * views.front().frame / 4 * 4;  // rows come in fours
    // Y = W L^-T with the landmark's information L L^T, so that W (L L^T)^-1 W^T = Y Y^T.
    const auto right = inverseTransposed(fit.information().matrixL());
    Eigen::Map<Eigen::MatrixXd> Y(Y_.data() + std::size_t(columns_) * stride_, stride_, kLandmark);
    const double shared = fit.sharedError_px() / fit.sharedErrorSigma_px();
    shared_squared_ += shared * shared;
    Matrix24d rest = Matrix24d::Zero();
    rest.row(kRest - 1) = shared / fit.sharedErrorSigma_px() * right.row(3);
    const auto linear = fit.views();
    int row = first_row_;
    for (std::size_t i = 0; i < views.size(); ++i) {
      addOuterProducts<true>(linear[i].J, linear[i].J, own_[views[i].frame]);
      const Eigen::Matrix<double, 3, kLandmark, Eigen::RowMajor> B = rowProduct(linear[i].B, right);
      Matrix84d W = Matrix84d::Zero();
      addOuterProducts(linear[i].J, B, W);
      const int own = rows_ * views[i].frame;
      if (row < own) Y.middleRows(row, own - row).setZero();
      Y.middleRows<kPose>(own) = W.topRows<kPose>();
      if (rows_ == kShakenPose) Y.row(own + kPose) = W.row(kPose);  // a shake does what an offset does, in its frame
      row = own + rows_;
      rest += W.bottomRows<kRest>();
    }
    Y.middleRows(row, size_ - kRest - row).setZero();
    Y.middleRows<kRest>(size_ - kRest) = rest;
    columns_ += kLandmark;
  }

  /// The lower triangle of the system in (frame by frame: steps of the pose, shake; offset, right-hand side).
  Eigen::MatrixXd system() {
    subtract();
    Eigen::MatrixXd system = Eigen::Map<Eigen::MatrixXd>(system_.data(), stride_, size_).topRows(size_);
    const int offset = size_ - kRest, right = offset + 1;
    for (int k = 0; k < static_cast<int>(own_.size()); ++k) {
      const Matrix8d& own = own_[k];
      const int at = rows_ * k;
      for (int j = 0; j < rows_; ++j) {
        for (int i = j; i < rows_; ++i) system(at + i, at + j) += own(i, j);
        system(offset, at + j) += own(kPose, j);
        system(right, at + j) += own(kPose + 1, j);
      }
      system(offset, offset) += own(kPose, kPose);
      system(right, offset) += own(kPose + 1, kPose);
      system(right, right) += own(kPose + 1, kPose + 1);
    }
    system(right, right) += shared_squared_;
    return system;
  }

 private:
  static constexpr int kColumns = 12 * kLandmark;

  void subtract() {
    if (columns_ == 0) return;
    double* const corner = system_.data() + first_row_ + std::size_t(first_row_) * stride_;
    subtractOuterProduct(corner, stride_, Y_.data() + first_row_, stride_, size_ - first_row_, columns_);
    columns_ = 0;
  }

  std::vector<Matrix8d> own_;  // J' J of each frame, J = [A D r]; lower triangle
  double shared_squared_ = 0;
  int rows_, size_, stride_, columns_ = 0, first_row_ = 0;
  std::vector<double> Y_, system_;  // the landmarks that are still to be subtracted; lower triangle
};

/// Information of the prior of shakes: each is white noise. Their mean is held at zero, as what all frames share is an
/// offset.
Eigen::MatrixXd priorOfShakes(int frames, double sigma_px) {
  constexpr double kOfMean = 1e3;
  const Eigen::MatrixXd ones = Eigen::MatrixXd::Ones(frames, frames);
  return (Eigen::MatrixXd::Identity(frames, frames) + kOfMean * ones) / (sigma_px * sigma_px);
}

/// Takes the shakes out of a system that is linear around those that are known. Both are lower triangles.
Eigen::MatrixXd eliminateShakes(const Eigen::MatrixXd& system, double sigma_px, const std::vector<double>& known_px,
                                std::vector<FrameShake>& shakes) {
  std::vector<int> shaken, others;
  for (int row = 0; row < system.rows(); ++row)
    (row % kShakenPose == kPose && row + kRest < system.rows() ? shaken : others).push_back(row);
  const int n = static_cast<int>(shaken.size()), rest = static_cast<int>(others.size()), ld = padded(n + rest);
  Eigen::VectorXd px = Eigen::VectorXd::Zero(n);
  if (!known_px.empty()) px = Eigen::Map<const Eigen::VectorXd>(known_px.data(), n);
  const Eigen::MatrixXd prior = priorOfShakes(n, sigma_px);
  const Eigen::VectorXd of_prior = prior * px;
  Eigen::MatrixXd panel(ld, n), reduced(padded(rest), rest);
  for (int j = 0; j < n; ++j) {
    for (int i = j; i < n; ++i) panel(i, j) = prior(i, j) + system(shaken[i], shaken[j]);
    for (int i = 0; i < rest; ++i)
      panel(n + i, j) = system(std::max(shaken[j], others[i]), std::min(shaken[j], others[i]));
    panel(n + rest - 1, j) += of_prior[j];
  }
  for (int j = 0; j < rest; ++j)
    for (int i = j; i < rest; ++i) reduced(i, j) = system(others[i], others[j]);
  reduced(rest - 1, rest - 1) += px.dot(of_prior);
  std::vector<int> singular;  // none, as there are priors
  factorizePanel({panel.data(), ld, n + rest, n}, singular);
  subtractOuterProduct(reduced.data(), padded(rest), panel.data() + n, ld, rest, n);
  const auto L = panel.topRows(n).triangularView<Eigen::Lower>();
  px -= L.transpose().solve(panel.row(n + rest - 1).transpose());
  const Eigen::MatrixXd inverse = L.solve(Eigen::MatrixXd::Identity(n, n));
  for (int k = 0; k < n; ++k) shakes.push_back({px[k], inverse.col(k).squaredNorm()});
  return reduced.topRows(rest);
}

/// Landmarks in the order of their first frames.
std::vector<int> byFirstFrame(const LandmarkViews& landmarks) {
  std::vector<int> order(landmarks.count());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](int j) HWY_ATTR { return landmarks.of(j).front().frame; });
  return order;
}

}  // namespace

EliminatedLandmarks eliminate(const StereoCamera& camera, const LandmarkNoise& noise, const LandmarkViews& landmarks,
                              FramePose pose, std::vector<SE3> T_cam_body, double offset_px) {
  EliminatedLandmarks result{.pose = pose,
                             .T_cam_body = std::move(T_cam_body),
                             .offset_px = offset_px,
                             .system = {},
                             .shakes = {},
                             .estimates = {}};
  result.estimates.resize(landmarks.count());
  LandmarkFit fit(camera, noise, pose, result.T_cam_body, offset_px);
  const bool shaken = noise.shake_sigma_px > 0;
  LandmarkSum sum(static_cast<int>(result.T_cam_body.size()), shaken);
  for (const int j : byFirstFrame(landmarks)) {
    if (!fit(landmarks.of(j), landmarks.before.empty() ? std::nullopt : landmarks.before[j])) continue;
    result.estimates[j] = fit.estimate();
    sum.add(landmarks.of(j), fit);
  }
  const Eigen::MatrixXd system = sum.system();
  pack(shaken ? eliminateShakes(system, noise.shake_sigma_px, landmarks.shakes_px, result.shakes) : system,
       result.system);
  return result;
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace motorcade {

MOTORCADE_EXPORT(eliminate);

EliminatedLandmarks eliminateLandmarks(const StereoCamera& camera, const LandmarkNoise& noise,
                                       const LandmarkViews& landmarks, FramePose pose, std::vector<SE3> T_cam_body,
                                       double offset_px) {
  return MOTORCADE_KERNEL(eliminate)(camera, noise, landmarks, pose, std::move(T_cam_body), offset_px);
}

}  // namespace motorcade
#endif
