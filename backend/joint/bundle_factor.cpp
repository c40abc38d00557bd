#include "backend/joint/bundle_factor.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Cholesky>

#include "backend/elimination/dense_kernels.hpp"
#include "backend/graph/symmetric_product.hpp"
#include "backend/joint/row_products.hpp"

namespace motorcade {
namespace {

constexpr int kLandmark = 4;  // unknowns of a landmark
constexpr int kRest = 2;      // columns of the offset and of the right-hand side

constexpr double kStill = 1e-9;  // m, rad and px: of a displacement whose Jacobian is 1, of poses that have not moved

using Matrix8d = Eigen::Matrix<double, 6 + kRest, 6 + kRest>;
using Matrix84d = Eigen::Matrix<double, 6 + kRest, kLandmark>;
using Matrix24d = Eigen::Matrix<double, kRest, kLandmark>;

/// Sums up the system that the elimination of landmarks leaves. They come in the order of their first frames: several
/// are subtracted at a time, from the first's first frame on.
class LandmarkSum {
 public:
  explicit LandmarkSum(int frames)
      : own_(frames, Matrix8d::Zero()),
        size_(6 * frames + kRest),
        stride_(padded(size_)),
        Y_(std::size_t(stride_) * kColumns, 0.0),
        system_(std::size_t(stride_) * size_, 0.0) {}

  void add(std::span<const LandmarkView> views, const LandmarkFit& fit) {
    if (columns_ == kColumns) subtract();
    if (columns_ == 0) first_row_ = 6 * views.front().frame / 4 * 4;  // rows come in fours
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
      const int own = 6 * views[i].frame;
      if (row < own) Y.middleRows(row, own - row).setZero();
      Y.middleRows<6>(own) = W.topRows<6>();
      row = own + 6;
      rest += W.bottomRows<kRest>();
    }
    Y.middleRows(row, size_ - kRest - row).setZero();
    Y.middleRows<kRest>(size_ - kRest) = rest;
    columns_ += kLandmark;
  }

  Quadratic packed() {
    subtract();
    Quadratic system;
    pack(Eigen::Map<Eigen::MatrixXd>(system_.data(), stride_, size_).topRows(size_), system);
    const int n = size_ - 1, offset = n - 1;
    for (int at = 0; at < offset; at += 6) {
      const Matrix8d& own = own_[at / 6];
      for (int j = 0; j < 6; ++j) {
        double* const column = system.lower_H.data() + PackedTriangle::offset(n, at + j);
        for (int i = j; i < 6; ++i) column[at + i] += own(i, j);
        column[offset] += own(6, j);
        system.g_c[at + j] += own(7, j);
      }
      system.lower_H.back() += own(6, 6);
      system.g_c.tail<kRest>() += own.row(7).tail<kRest>();
    }
    system.g_c[n] += shared_squared_;
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
  int size_, stride_, columns_ = 0, first_row_ = 0;
  std::vector<double> Y_, system_;  // the landmarks that are still to be subtracted; lower triangle
};

/// Landmarks in the order of their first frames.
std::vector<int> byFirstFrame(const LandmarkViews& landmarks) {
  std::vector<int> order(landmarks.count());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, {}, [&](int j) { return landmarks.of(j).front().frame; });
  return order;
}

/// M <- S^-1 M, with S from a step of the frame's pose to a perturbation of T_cam_body on the left.
template <class Rows>
void turnToSteps(FramePose pose, const SE3& T_cam_body, Rows& M) {
  if (pose == FramePose::kCamBody) {
    M.template topRows<3>() -= hat(T_cam_body.translation()) * M.template bottomRows<3>();
  } else {
    const Eigen::Matrix3d minus_R = -T_cam_body.rotation().transpose();
    M.template topRows<3>() = (minus_R * M.template topRows<3>()).eval();
    M.template bottomRows<3>() = (minus_R * M.template bottomRows<3>()).eval();
  }
}

/// M <- M S.
void turnFromSteps(FramePose pose, const SE3& T_cam_body, Matrix6d& M) {
  if (pose == FramePose::kCamBody) {
    M.rightCols<3>() += M.leftCols<3>() * hat(T_cam_body.translation());
  } else {
    const Eigen::Matrix3d minus_R = -T_cam_body.rotation();
    M.leftCols<3>() = (M.leftCols<3>() * minus_R).eval();
    M.rightCols<3>() = (M.rightCols<3>() * minus_R).eval();
  }
}

/// What a step of the last frame's pose does to the motion D of a frame relative to it, is undone by this step of the
/// frame's own pose.
Matrix6d likeStepOfLast(FramePose pose, const SE3& T_cam_body, const SE3& D) {
  Matrix6d J = Matrix6d::Identity();
  if (pose == FramePose::kCamBody)
    J.topLeftCorner<3, 3>() = J.bottomRightCorner<3, 3>() = D.rotation();
  else
    J.topRightCorner<3, 3>() = hat(T_cam_body.rotation().transpose() * D.translation());
  return J;
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
}

/// Residuals added up by half of the image and frame, for ResidualLevels.
class CommonSums {
 public:
  CommonSums(double middle_px, std::size_t frames)
      : middle_px_(middle_px), sums_(2 * frames, Eigen::Vector3d::Zero()) {}

  void add(std::span<const LandmarkView> views, const LandmarkFit& fit) {
    const double full = std::sqrt(1 / fit.informationShare());
    for (std::size_t i = 0; i < views.size(); ++i)
      sums_[2 * views[i].frame + (views[i].uvd_px.x() > middle_px_ ? 1 : 0)] += full * fit.views()[i].r();
  }
  double squares() const {
    double squares = 0;
    for (const Eigen::Vector3d& sum : sums_) squares += sum.squaredNorm();
    return squares;
  }

 private:
  double middle_px_;
  std::vector<Eigen::Vector3d> sums_;
};

}  // namespace

EliminatedLandmarks eliminateLandmarks(const StereoCamera& camera, const LandmarkNoise& noise,
                                       const LandmarkViews& landmarks, FramePose pose, std::vector<SE3> T_cam_body,
                                       double offset_px) {
  EliminatedLandmarks result{.pose = pose,
                             .T_cam_body = std::move(T_cam_body),
                             .offset_px = offset_px,
                             .system = {},
                             .levels = {},
                             .estimates = {}};
  result.estimates.resize(landmarks.count());
  LandmarkFit fit(camera, noise, pose, result.T_cam_body, offset_px);
  LandmarkSum sum(static_cast<int>(result.T_cam_body.size()));
  CommonSums common(0.5 * camera.width_px, result.T_cam_body.size());
  for (const int j : byFirstFrame(landmarks)) {
    if (!fit(landmarks.of(j), landmarks.before.empty() ? std::nullopt : landmarks.before[j])) continue;
    result.estimates[j] = fit.estimate();
    sum.add(landmarks.of(j), fit);
    addLevels(fit, result.levels);
    common.add(landmarks.of(j), fit);
  }
  result.levels.common_sum = common.squares();
  result.system = sum.packed();
  return result;
}

BundleFactor::BundleFactor(std::vector<VariableId> poses, VariableId offset, EliminatedLandmarks landmarks)
    : InformationFactor((poses.push_back(offset), poses), static_cast<int>(landmarks.system.g_c.size())),
      frames_(static_cast<int>(landmarks.T_cam_body.size())),
      landmarks_(std::move(landmarks)) {
  const SE3 last = landmarks_.T_cam_body.back().inverse();
  for (const SE3& T : landmarks_.T_cam_body) D_inverse_.push_back((T * last).inverse());
}

std::vector<SE3> BundleFactor::posesFromCamera(std::span<const Value* const> values) const {
  std::vector<SE3> T_cam_body;
  for (int k = 0; k < frames_; ++k) {
    const auto& pose = std::get<SE3>(*values[k]);
    T_cam_body.push_back(landmarks_.pose == FramePose::kWorldCam ? pose.inverse() : pose);
  }
  return T_cam_body;
}

double BundleFactor::offset_px(std::span<const Value* const> values) {
  return std::get<SmallVector>(*values.back())[0];
}

const Quadratic* BundleFactor::heldModel(std::span<const Value* const> values) const {
  if (std::abs(offset_px(values) - landmarks_.offset_px) > kStill) return nullptr;
  const bool still = std::ranges::equal(posesFromCamera(values), landmarks_.T_cam_body, [](const SE3& a, const SE3& b) {
    return (a.translation() - b.translation()).squaredNorm() < kStill * kStill &&
           (a.rotation() - b.rotation()).squaredNorm() < kStill * kStill;
  });
  return still ? &landmarks_.system : nullptr;
}

BundleFactor::Displacement BundleFactor::displacement(std::span<const SE3> T_cam_body, double offset_px) const {
  Displacement d{.e = Eigen::VectorXd::Zero(rows() - 1), .J = {}, .J_last = {}};
  d.e[6 * frames_] = offset_px - landmarks_.offset_px;
  const SE3 T_body_last = T_cam_body.back().inverse();
  for (int k = 0; k + 1 < frames_; ++k) {
    const SE3 D = T_cam_body[k] * T_body_last;
    Vector6d e = (D * D_inverse_[k]).log();
    const bool still = e.squaredNorm() < kStill * kStill;
    Matrix6d J = still ? Matrix6d::Identity() : rightJacobianInverseSE3(-e);
    turnToSteps(landmarks_.pose, landmarks_.T_cam_body[k], e);
    turnToSteps(landmarks_.pose, landmarks_.T_cam_body[k], J);
    turnFromSteps(landmarks_.pose, T_cam_body[k], J);
    d.e.segment<6>(6 * k) = e;
    d.J.push_back(J);
    d.J_last.push_back(likeStepOfLast(landmarks_.pose, T_cam_body[k], D));
  }
  return d;
}

Eigen::VectorXd BundleFactor::gradientAt(const Eigen::VectorXd& e) const {
  const Eigen::Index n = e.size(), last = 6 * (frames_ - 1);
  const Eigen::VectorXd& g0 = landmarks_.system.g_c;
  Eigen::VectorXd g_c(n + 1);
  g_c.setZero();
  addSymmetricProduct(landmarks_.system.matrix(), e.data(), g_c.data());
  g_c[n] = g0[n] + e.dot(g_c.head(n)) + 2 * e.dot(g0.head(n));
  g_c.head(n) += g0.head(n);
  g_c.segment<6>(last).setZero();  // all motions are relative to the last pose
  return g_c;
}

void BundleFactor::gradient(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> g_c) const {
  const Displacement d = displacement(posesFromCamera(values), offset_px(values));
  g_c = gradientAt(d.e);
  const int last = 6 * (frames_ - 1);
  for (int k = 0; k + 1 < frames_; ++k) {
    const Vector6d g = d.J[k].transpose() * g_c.segment<6>(6 * k);
    g_c.segment<6>(6 * k) = g;
    g_c.segment<6>(last).noalias() -= d.J_last[k].transpose() * g;
  }
}

void BundleFactor::linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const {
  const Displacement d = displacement(posesFromCamera(values), offset_px(values));
  fillPoses(d, term);
  const int last = 6 * (frames_ - 1), rest = last + 6;
  Eigen::Matrix<double, kRest, Eigen::Dynamic> offset_g(kRest, rest + 1);
  const Eigen::VectorXd g_c = gradientAt(d.e);
  const PackedTriangle H = landmarks_.system.matrix();
  for (int j = 0; j <= rest; ++j) offset_g.col(j) << H.column(j)[rest], g_c[j];
  Eigen::Matrix<double, kRest, 6> of_last = Eigen::Matrix<double, kRest, 6>::Zero();
  for (int k = 0; k + 1 < frames_; ++k) {
    const Eigen::Matrix<double, kRest, 6> own = offset_g.middleCols<6>(6 * k) * d.J[k];
    term.block<kRest, 6>(rest, 6 * k) = own;
    of_last.noalias() -= own * d.J_last[k];
  }
  term.block<kRest, 6>(rest, last) = of_last;
  term.block<kRest, 1>(rest, rest) = offset_g.col(rest);
  term(rest + 1, rest + 1) = g_c[rest + 1];
}

/// Of H, in the lower triangle or on its diagonal.
Matrix6d BundleFactor::block(int i, int j) const {
  const PackedTriangle H = landmarks_.system.matrix();
  Matrix6d block;
  for (int c = 0; c < 6; ++c) {
    const double* const column = H.column(6 * j + c) + 6 * i;
    for (int r = i == j ? c : 0; r < 6; ++r) block(r, c) = column[r];
  }
  if (i == j) block.triangularView<Eigen::StrictlyUpper>() = block.transpose();
  return block;
}

/// The poses' part of the lower triangle: J' H J block by block, and the last pose's rows as sums of the others'.
void BundleFactor::fillPoses(const Displacement& d, Eigen::Ref<Eigen::MatrixXd> term) const {
  const int others = frames_ - 1;
  std::vector<Matrix6d> sums(others, Matrix6d::Zero());
  for (int j = 0; j < others; ++j)
    for (int i = j; i < others; ++i) {
      const Matrix6d H = block(i, j), H_J = H * d.J[j], moved = d.J[i].transpose() * H_J;
      term.block<6, 6>(6 * i, 6 * j) = moved;
      sums[j].noalias() += d.J_last[i].transpose() * moved;
      if (i != j) sums[i].noalias() += (moved * d.J_last[j]).transpose();
    }
  Matrix6d last = Matrix6d::Zero();
  for (int j = 0; j < others; ++j) {
    term.block<6, 6>(6 * others, 6 * j) = -sums[j];
    last.noalias() += sums[j] * d.J_last[j];
  }
  term.block<6, 6>(6 * others, 6 * others) = last;
}

}  // namespace motorcade
