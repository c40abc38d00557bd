#include "backend/joint/bundle_factor.hpp"

#include <algorithm>
#include <cmath>

#include "backend/graph/symmetric_product.hpp"

namespace motorcade {
namespace {

constexpr int kTail = 2;  // columns of the offset and of the right-hand side

constexpr double kStill = 1e-9;  // m, rad and px: of a displacement whose Jacobian is 1, of poses that have not moved

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

}  // namespace

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
  Eigen::Matrix<double, kTail, Eigen::Dynamic> offset_g(kTail, rest + 1);
  const Eigen::VectorXd g_c = gradientAt(d.e);
  const PackedTriangle H = landmarks_.system.matrix();
  for (int j = 0; j <= rest; ++j) offset_g.col(j) << H.column(j)[rest], g_c[j];
  Eigen::Matrix<double, kTail, 6> of_last = Eigen::Matrix<double, kTail, 6>::Zero();
  for (int k = 0; k + 1 < frames_; ++k) {
    const Eigen::Matrix<double, kTail, 6> own = offset_g.middleCols<6>(6 * k) * d.J[k];
    term.block<kTail, 6>(rest, 6 * k) = own;
    of_last.noalias() -= own * d.J_last[k];
  }
  term.block<kTail, 6>(rest, last) = of_last;
  term.block<kTail, 1>(rest, rest) = offset_g.col(rest);
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
