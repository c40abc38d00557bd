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

std::vector<VariableId> BundleFactor::Variables::all() const {
  std::vector<VariableId> all = cameras;
  all.insert(all.end(), bodies.begin(), bodies.end());
  all.push_back(offset);
  return all;
}

BundleFactor::BundleFactor(const Variables& variables, EliminatedLandmarks landmarks)
    : Factor(variables.all(), Form::kInformation,
             static_cast<int>(6 * (variables.cameras.size() + variables.bodies.size())) + kRest),
      frames_(static_cast<int>(variables.cameras.size())),
      moving_(!variables.bodies.empty()),
      landmarks_(std::move(landmarks)) {
  const SE3 last = landmarks_.T_cam_body.back().inverse();
  for (const SE3& T : landmarks_.T_cam_body) D_inverse_.push_back((T * last).inverse());
}

void BundleFactor::residual(std::span<const Value* const>, Eigen::Ref<Eigen::VectorXd>) const {
  assert(false && "a quadratic in information form has no residual");
}

std::vector<SE3> BundleFactor::relativePoses(std::span<const Value* const> values) const {
  std::vector<SE3> T_cam_body;
  for (int k = 0; k < frames_; ++k) {
    const SE3 T_cam_world = std::get<SE3>(*values[k]).inverse();
    T_cam_body.push_back(moving_ ? T_cam_world * std::get<SE3>(*values[frames_ + k]) : T_cam_world);
  }
  return T_cam_body;
}

/// [H g; g' c] in left perturbations of T_cam_body at these values.
Eigen::MatrixXd BundleFactor::systemAt(std::span<const SE3> T_cam_body, double offset_px) const {
  const int last = 6 * (frames_ - 1), size = static_cast<int>(landmarks_.system.rows());
  Eigen::MatrixXd system = landmarks_.system;
  Eigen::VectorXd e = Eigen::VectorXd::Zero(size - 1);
  e[size - kRest] = offset_px - landmarks_.offset_px;
  const SE3 T_body_last = T_cam_body.back().inverse();
  std::vector<Matrix6d> J_last(frames_ - 1);  // d e_k / d (perturbation of the last pose)
  for (int k = 0; k + 1 < frames_; ++k) {
    const SE3 D = T_cam_body[k] * T_body_last;
    e.segment<6>(6 * k) = (D * D_inverse_[k]).log();
    J_last[k] = -D.adjoint();
  }
  // The last pose has no column of its own: all motions are relative to it.
  system.middleCols<6>(last).setZero();
  system.middleRows<6>(last).setZero();
  const Eigen::VectorXd shift = system.topLeftCorner(size - 1, size - 1) * e;
  system(size - 1, size - 1) += e.dot(shift) + 2 * e.dot(system.col(size - 1).head(size - 1));
  system.col(size - 1).head(size - 1) += shift;
  system.row(size - 1).head(size - 1) = system.col(size - 1).head(size - 1).transpose();
  for (int k = 0; k + 1 < frames_; ++k) {
    Vector6d minus = -e.segment<6>(6 * k);
    const Matrix6d J = rightJacobianInverseSE3(minus);
    system.middleCols<6>(6 * k) = (system.middleCols<6>(6 * k) * J).eval();
    system.middleRows<6>(6 * k) = (J.transpose() * system.middleRows<6>(6 * k)).eval();
  }
  for (int k = 0; k + 1 < frames_; ++k) system.middleCols<6>(last).noalias() += system.middleCols<6>(6 * k) * J_last[k];
  for (int k = 0; k + 1 < frames_; ++k)
    system.middleRows<6>(last).noalias() += J_last[k].transpose() * system.middleRows<6>(6 * k);
  return system;
}

/// From left perturbations e of T_cam_body = x^-1 T to right ones of x and T: e = Ad(T_cam_body) dT - dx.
void BundleFactor::linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const {
  const std::vector<SE3> T_cam_body = relativePoses(values);
  const Eigen::MatrixXd system = systemAt(T_cam_body, std::get<SmallVector>(*values.back())[0]);
  const int n = 6 * frames_, rest = static_cast<int>(term.rows()) - kRest;
  term.topLeftCorner(n, n) = system.topLeftCorner(n, n);
  term.block(rest, 0, kRest, n) = -system.bottomLeftCorner(kRest, n);
  term.bottomRightCorner<kRest, kRest>() = system.bottomRightCorner<kRest, kRest>();
  if (moving_) {
    Eigen::MatrixXd turned(n + kRest, n);  // system * Ad
    for (int k = 0; k < frames_; ++k)
      turned.middleCols<6>(6 * k).noalias() = system.middleCols<6>(6 * k) * T_cam_body[k].adjoint();
    for (int k = 0; k < frames_; ++k)
      term.block(n + 6 * k, n, 6, n).noalias() = T_cam_body[k].adjoint().transpose() * turned.middleRows<6>(6 * k);
    term.block(n, 0, n, n) = -turned.topRows(n).transpose();
    term.block(rest, n, kRest, n) = turned.bottomRows(kRest);
  }
  term.triangularView<Eigen::StrictlyUpper>() = term.transpose();
}

}  // namespace motorcade
