#include "backend/joint/bundle_factor.hpp"

#include <cassert>

#include <Eigen/Cholesky>

namespace motorcade {
namespace {

constexpr int kLandmark = 4;  // unknowns of a landmark
constexpr int kRest = 2;      // columns of the offset and of the right-hand side

/// Adds a landmark's views to the lower triangle of [A D r]'[A D r], and their coupling with the landmark to W.
void addViews(std::span<const LandmarkView> views, std::span<const LinearView> linear, Eigen::MatrixXd& system,
              Eigen::Ref<Eigen::MatrixXd> W) {
  const int one = static_cast<int>(system.rows()) - 1, offset = one - 1;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const LinearView& l = linear[i];
    const int at = 6 * views[i].frame;
    system.block<6, 6>(at, at).noalias() += l.A.transpose() * l.A;
    system.block<1, 6>(offset, at) += l.D * l.A.row(2);
    system.block<1, 6>(one, at).noalias() += l.r.transpose() * l.A;
    system(offset, offset) += l.D * l.D;
    system(one, offset) += l.D * l.r.z();
    system(one, one) += l.r.squaredNorm();
    W.middleRows<6>(at).noalias() = l.A.transpose() * l.B;
    W.row(offset) += l.D * l.B.row(2);
    W.row(one).noalias() += l.r.transpose() * l.B;
  }
}

void addLevels(std::span<const LinearView> linear, ResidualLevels& levels) {
  for (const LinearView& l : linear) {
    levels.uv_sum += l.r.head<2>().squaredNorm();
    levels.d_sum += l.r.z() * l.r.z();
  }
  levels.uv_count += 2.0 * static_cast<double>(linear.size() - 1);
  levels.d_count += static_cast<double>(linear.size() - 1);
}

}  // namespace

EliminatedLandmarks eliminateLandmarks(const StereoCamera& camera, const LandmarkNoise& noise,
                                       const LandmarkViews& landmarks, std::vector<SE3> T_cam_body,
                                       double offset_px) {
  EliminatedLandmarks result{.T_cam_body = std::move(T_cam_body), .offset_px = offset_px, .system = {}, .levels = {}};
  LandmarkFit fit(camera, noise, result.T_cam_body, offset_px);
  const int size = 6 * static_cast<int>(result.T_cam_body.size()) + kRest;
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(size, size);
  Eigen::MatrixXd Y = Eigen::MatrixXd::Zero(size, kLandmark * landmarks.count());
  for (int j = 0; j < landmarks.count(); ++j) {
    if (!fit(landmarks.of(j))) continue;
    auto W = Y.middleCols<kLandmark>(kLandmark * j);
    addViews(landmarks.of(j), fit.views(), system, W);
    addLevels(fit.views(), result.levels);
    const double shared = fit.sharedError_px() / fit.sharedErrorSigma_px();
    system(size - 1, size - 1) += shared * shared;
    W(size - 1, 3) += shared / fit.sharedErrorSigma_px();
    fit.information().llt().matrixU().solveInPlace<Eigen::OnTheRight>(W);
  }
  system.selfadjointView<Eigen::Lower>().rankUpdate(Y, -1.0);
  result.system = system.selfadjointView<Eigen::Lower>();
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
