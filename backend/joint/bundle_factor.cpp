#include "backend/joint/bundle_factor.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

#include <Eigen/Cholesky>

#include "backend/elimination/dense_kernels.hpp"

namespace motorcade {
namespace {

constexpr int kLandmark = 4;  // unknowns of a landmark
constexpr int kRest = 2;      // columns of the offset and of the right-hand side

using Matrix8d = Eigen::Matrix<double, 6 + kRest, 6 + kRest>;
using Matrix84d = Eigen::Matrix<double, 6 + kRest, kLandmark>;

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
    const Matrix4d L = fit.information().llt().matrixL();
    const Matrix4d right = L.triangularView<Eigen::Lower>().solve(Matrix4d::Identity()).transpose();
    Eigen::Map<Eigen::MatrixXd> Y(Y_.data() + std::size_t(columns_) * stride_, stride_, kLandmark);
    const double shared = fit.sharedError_px() / fit.sharedErrorSigma_px();
    shared_squared_ += shared * shared;
    Y.row(size_ - 1) = shared / fit.sharedErrorSigma_px() * right.row(3);
    const auto linear = fit.views();
    for (std::size_t i = 0; i < views.size(); ++i) {
      own_[views[i].frame].noalias() += linear[i].J.transpose() * linear[i].J;
      const Eigen::Matrix<double, 3, kLandmark, Eigen::RowMajor> B = linear[i].B * right;
      const Matrix84d W = linear[i].J.transpose() * B;
      Y.block<6, kLandmark>(6 * views[i].frame, 0) = W.topRows<6>();
      Y.block<kRest, kLandmark>(size_ - kRest, 0) += W.bottomRows<kRest>();
    }
    columns_ += kLandmark;
  }

  Eigen::MatrixXd symmetric() {
    subtract();
    Eigen::MatrixXd system = Eigen::Map<Eigen::MatrixXd>(system_.data(), stride_, size_).topRows(size_);
    const int rest = size_ - kRest;
    for (int at = 0; at < rest; at += 6) {
      const Matrix8d& own = own_[at / 6];
      system.block<6, 6>(at, at) += own.topLeftCorner<6, 6>();
      system.block<kRest, 6>(rest, at) += own.bottomLeftCorner<kRest, 6>();
      system.bottomRightCorner<kRest, kRest>() += own.bottomRightCorner<kRest, kRest>();
    }
    system(rest + 1, rest + 1) += shared_squared_;
    system.triangularView<Eigen::StrictlyUpper>() = system.transpose();
    return system;
  }

 private:
  static constexpr int kColumns = 12 * kLandmark;

  void subtract() {
    if (columns_ == 0) return;
    double* const corner = system_.data() + first_row_ + std::size_t(first_row_) * stride_;
    subtractOuterProduct(corner, stride_, Y_.data() + first_row_, stride_, size_ - first_row_, columns_);
    std::ranges::fill(Y_, 0.0);
    columns_ = 0;
  }

  std::vector<Matrix8d> own_;  // J' J of each frame, J = [A D r]
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

void addLevels(std::span<const LinearView> linear, ResidualLevels& levels) {
  for (const LinearView& l : linear) {
    levels.uv_sum += l.r().head<2>().squaredNorm();
    levels.d_sum += l.r().z() * l.r().z();
  }
  for (std::size_t i = 1; i < linear.size(); ++i) levels.successive_sum += linear[i - 1].r().dot(linear[i].r());
  levels.uv_count += 2.0 * static_cast<double>(linear.size() - 1);
  levels.d_count += static_cast<double>(linear.size() - 1);
}

/// Residuals added up by half of the image and frame, for ResidualLevels.
class CommonSums {
 public:
  CommonSums(double middle_px, std::size_t frames)
      : middle_px_(middle_px), sums_(2 * frames, Eigen::Vector3d::Zero()) {}

  void add(std::span<const LandmarkView> views, std::span<const LinearView> linear) {
    for (std::size_t i = 0; i < views.size(); ++i)
      sums_[2 * views[i].frame + (views[i].uvd_px.x() > middle_px_ ? 1 : 0)] += linear[i].r();
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
                                       const LandmarkViews& landmarks, std::vector<SE3> T_cam_body, double offset_px) {
  EliminatedLandmarks result{.T_cam_body = std::move(T_cam_body), .offset_px = offset_px, .system = {}, .levels = {}};
  LandmarkFit fit(camera, noise, result.T_cam_body, offset_px);
  LandmarkSum sum(static_cast<int>(result.T_cam_body.size()));
  CommonSums common(0.5 * camera.width_px, result.T_cam_body.size());
  for (const int j : byFirstFrame(landmarks)) {
    if (!fit(landmarks.of(j))) continue;
    sum.add(landmarks.of(j), fit);
    addLevels(fit.views(), result.levels);
    common.add(landmarks.of(j), fit.views());
  }
  result.levels.common_sum = common.squares();
  result.system = sum.symmetric();
  return result;
}

BundleFactor::BundleFactor(Poses kind, std::vector<VariableId> poses, VariableId offset, EliminatedLandmarks landmarks)
    : Factor((poses.push_back(offset), poses), Form::kInformation, static_cast<int>(landmarks.system.rows())),
      kind_(kind),
      frames_(static_cast<int>(landmarks.T_cam_body.size())),
      landmarks_(std::move(landmarks)) {
  const SE3 last = landmarks_.T_cam_body.back().inverse();
  for (const SE3& T : landmarks_.T_cam_body) D_inverse_.push_back((T * last).inverse());
}

void BundleFactor::residual(std::span<const Value* const>, Eigen::Ref<Eigen::VectorXd>) const {
  assert(false && "a quadratic in information form has no residual");
}

std::vector<SE3> BundleFactor::posesFromCamera(std::span<const Value* const> values) const {
  std::vector<SE3> T_cam_body;
  for (int k = 0; k < frames_; ++k) {
    const auto& pose = std::get<SE3>(*values[k]);
    T_cam_body.push_back(kind_ == Poses::kWorldCam ? pose.inverse() : pose);
  }
  return T_cam_body;
}

BundleFactor::Displacement BundleFactor::displacement(std::span<const SE3> T_cam_body, double offset_px) const {
  Displacement d{.e = Eigen::VectorXd::Zero(landmarks_.system.rows() - 1), .J = {}, .J_last = {}};
  d.e[6 * frames_] = offset_px - landmarks_.offset_px;
  const SE3 T_body_last = T_cam_body.back().inverse();
  for (int k = 0; k + 1 < frames_; ++k) {
    const SE3 D = T_cam_body[k] * T_body_last;
    const Vector6d e = (D * D_inverse_[k]).log();
    d.e.segment<6>(6 * k) = e;
    d.J.push_back(rightJacobianInverseSE3(-e));
    d.J_last.push_back(-D.adjoint());
  }
  return d;
}

Eigen::VectorXd BundleFactor::gradientAt(const Eigen::VectorXd& e) const {
  const Eigen::Index n = e.size(), last = 6 * (frames_ - 1);
  const auto g0 = landmarks_.system.col(n);
  Eigen::VectorXd g_c(n + 1);
  g_c.head(n).noalias() = landmarks_.system.topLeftCorner(n, n) * e;
  g_c[n] = g0[n] + e.dot(g_c.head(n)) + 2 * e.dot(g0.head(n));
  g_c.head(n) += g0.head(n);
  g_c.segment<6>(last).setZero();  // all motions are relative to the last pose
  return g_c;
}

/// [H g; g' c] in left perturbations of T_cam_body.
Eigen::MatrixXd BundleFactor::systemAt(const Displacement& d) const {
  const int last = 6 * (frames_ - 1), size = static_cast<int>(landmarks_.system.rows());
  Eigen::MatrixXd system = landmarks_.system;
  system.col(size - 1) = gradientAt(d.e);
  system.row(size - 1) = system.col(size - 1).transpose();
  system.middleCols<6>(last).setZero();
  system.middleRows<6>(last).setZero();
  for (int k = 0; k + 1 < frames_; ++k) {
    system.middleCols<6>(6 * k) = (system.middleCols<6>(6 * k) * d.J[k]).eval();
    system.middleCols<6>(last).noalias() += system.middleCols<6>(6 * k) * d.J_last[k];
  }
  for (int k = 0; k + 1 < frames_; ++k) {
    system.middleRows<6>(6 * k) = (d.J[k].transpose() * system.middleRows<6>(6 * k)).eval();
    system.middleRows<6>(last).noalias() += d.J_last[k].transpose() * system.middleRows<6>(6 * k);
  }
  return system;
}

/// Left perturbations e of T_cam_body by right ones d of the variables: e = -d of the camera's pose in the world,
/// e = Ad(T_cam_body) d of the body's.
void BundleFactor::gradient(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> g_c) const {
  const std::vector<SE3> T_cam_body = posesFromCamera(values);
  const Displacement d = displacement(T_cam_body, std::get<SmallVector>(*values.back())[0]);
  g_c = gradientAt(d.e);
  const int n = 6 * frames_, last = n - 6;
  for (int k = 0; k + 1 < frames_; ++k) {
    g_c.segment<6>(6 * k) = (d.J[k].transpose() * g_c.segment<6>(6 * k)).eval();
    g_c.segment<6>(last).noalias() += d.J_last[k].transpose() * g_c.segment<6>(6 * k);
  }
  if (kind_ == Poses::kWorldCam) {
    g_c.head(n) *= -1;
    return;
  }
  for (int k = 0; k < frames_; ++k)
    g_c.segment<6>(6 * k) = (T_cam_body[k].adjoint().transpose() * g_c.segment<6>(6 * k)).eval();
}

void BundleFactor::linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const {
  const std::vector<SE3> T_cam_body = posesFromCamera(values);
  term = systemAt(displacement(T_cam_body, std::get<SmallVector>(*values.back())[0]));
  const int n = 6 * frames_;
  if (kind_ == Poses::kWorldCam) {
    term.bottomLeftCorner<kRest, Eigen::Dynamic>(kRest, n) *= -1;
    term.topRightCorner<Eigen::Dynamic, kRest>(n, kRest) *= -1;
    return;
  }
  for (int k = 0; k < frames_; ++k) {
    const Matrix6d Ad = T_cam_body[k].adjoint();
    term.middleCols<6>(6 * k) = (term.middleCols<6>(6 * k) * Ad).eval();
    term.middleRows<6>(6 * k) = (Ad.transpose() * term.middleRows<6>(6 * k)).eval();
  }
}

}  // namespace motorcade
