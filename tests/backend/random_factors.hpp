#pragma once

#include <array>
#include <memory>
#include <vector>

#include "backend/factors/pose_factors.hpp"
#include "backend/graph/relative_pose_factor.hpp"
#include "core/decompositions.hpp"
#include "tests/backend/perturbation.hpp"
#include "tests/support/noise.hpp"

/// Seeded measurements between variables of every kind that a solver may hold.
namespace motorcade::test {

/// Holds a vector at a mean: r = (x - mean) / sigma
class VectorPrior final : public JacobianFactor {
 public:
  VectorPrior(VariableId v, const SmallVector& mean, double sigma)
      : JacobianFactor({v}, static_cast<int>(mean.size())), mean_(mean), sigma_(sigma) {}
  void linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const override {
    term.setIdentity();
    term /= sigma_;
    residual(values, term.col(mean_.size()));
  }
  void residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const override {
    r = (std::get<SmallVector>(*values[0]) - mean_) / sigma_;
  }

 private:
  SmallVector mean_;
  double sigma_;
};

/// Position of a variable: the origin of a pose, or a vector, bent so that its factors are not linear.
inline SmallVector positionOf(const Value& value) {
  if (const auto* pose = std::get_if<SE3>(&value)) return pose->translation();
  if (const auto* pose = std::get_if<SE2>(&value)) return pose->translation();
  const auto& x = std::get<SmallVector>(value);
  return x + SmallVector(0.1 * x.array().sin());
}

/// Row `i` of the derivative of `positionOf` under a right perturbation.
inline SmallVector positionGradient(const Value& value, int i) {
  SmallVector gradient = SmallVector::Zero(dimension(value));
  if (const auto* pose = std::get_if<SE3>(&value)) {
    gradient.head<3>() = pose->rotation().row(i);
  } else if (const auto* planar = std::get_if<SE2>(&value)) {
    gradient.head<2>() = planar->rotation().row(i);
  } else {
    gradient[i] = 1 + 0.1 * std::cos(std::get<SmallVector>(value)[i]);
  }
  return gradient;
}

/// Difference of two positions in as many components as both have:
///   r = (position(b) - position(a) - measured) / sigma
class PositionDifference final : public JacobianFactor {
 public:
  PositionDifference(VariableId a, VariableId b, const SmallVector& measured, double sigma)
      : JacobianFactor({a, b}, static_cast<int>(measured.size())), measured_(measured), sigma_(sigma) {}
  void linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const override {
    const int size_a = dimension(*values[0]), size_b = dimension(*values[1]);
    for (int i = 0; i < rows(); ++i) {
      term.row(i).head(size_a) = -positionGradient(*values[0], i).transpose() / sigma_;
      term.row(i).segment(size_a, size_b) = positionGradient(*values[1], i).transpose() / sigma_;
    }
    residual(values, term.col(size_a + size_b));
  }
  void residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const override {
    r = (positionOf(*values[1]).head(rows()) - positionOf(*values[0]).head(rows()) - measured_) / sigma_;
  }

 private:
  SmallVector measured_;
  double sigma_;
};

/// A pose sees a point, a vector of two or three numbers: r = (T^-1 p - measured) / sigma
class PointObservation final : public JacobianFactor {
 public:
  PointObservation(VariableId pose, VariableId point, const SmallVector& measured, double sigma)
      : JacobianFactor({pose, point}, static_cast<int>(measured.size())), measured_(measured), sigma_(sigma) {}

  static SmallVector seen(const Value& pose, const SmallVector& p) {
    if (const auto* space = std::get_if<SE3>(&pose)) return space->inverse() * Eigen::Vector3d(p);
    return std::get<SE2>(pose).inverse() * Eigen::Vector2d(p);
  }
  void linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const override {
    const SmallVector q = seen(*values[0], std::get<SmallVector>(*values[1]));
    if (const auto* space = std::get_if<SE3>(values[0])) {
      term.leftCols<3>() = -Eigen::Matrix3d::Identity();
      term.middleCols<3>(3) = hat(Eigen::Vector3d(q));
      term.middleCols<3>(6) = space->rotation().transpose();
    } else {
      term.leftCols<2>() = -Eigen::Matrix2d::Identity();
      term.col(2) = Eigen::Vector2d(q[1], -q[0]);
      term.middleCols<2>(3) = std::get<SE2>(*values[0]).rotation().transpose();
    }
    term /= sigma_;
    residual(values, term.col(term.cols() - 1));
  }
  void residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const override {
    r = (seen(*values[0], std::get<SmallVector>(*values[1])) - measured_) / sigma_;
  }

 private:
  SmallVector measured_;
  double sigma_;
};

/// Draws variables with a true value each, and measurements of them whose errors follow the stated noise.
class RandomWorld {
 public:
  enum class Kind { kSpace, kPlane, kVectors, kMixed };
  static constexpr std::array kKinds{Kind::kSpace, Kind::kPlane, Kind::kVectors, Kind::kMixed};
  static constexpr double kSigma_m = 0.05, kSigma_rad = 0.01;

  /// The loss is that of `encounter` and of half of the relative poses in space; one in ten of them is then an outlier.
  RandomWorld(std::uint64_t seed, Kind kind, RobustLoss loss = RobustLoss::kNone)
      : noise_(seed), kind_(kind), loss_(loss) {}

  /// Adds a variable to a FactorGraph or an IncrementalSolver.
  template <class Graph>
  VariableId addVariable(Graph& graph) {
    const Value truth = draw();
    const VariableId v = graph.addVariable(disturbed(truth, 2));
    truth_.resize(std::max(truth_.size(), static_cast<std::size_t>(v.value) + 1));
    truth_[v.value] = truth;
    return v;
  }
  const Value& truth(VariableId v) const { return truth_[v.value]; }

  /// `scale` multiplies the standard deviations.
  std::unique_ptr<const JacobianFactor> prior(VariableId v, double scale = 1) {
    const Value mean = disturbed(truth(v), scale);
    if (const auto* space = std::get_if<SE3>(&mean))
      return std::make_unique<PriorFactor>(std::array{v}, PriorModel{*space}, poseNoise(scale));
    if (const auto* planar = std::get_if<SE2>(&mean)) {
      const Eigen::Vector3d sigma = scale * sigmaOf(mean);
      return std::make_unique<PriorFactorSE2>(v, *planar,
                                              Eigen::Matrix3d(sigma.cwiseAbs2().cwiseInverse().asDiagonal()));
    }
    return std::make_unique<VectorPrior>(v, std::get<SmallVector>(mean), scale * kSigma_m);
  }

  /// True when `between` alone ties the second variable to the first in all its components.
  bool tiesFully(VariableId a, VariableId b) const {
    const Value &from = truth(a), &to = truth(b);
    if (std::holds_alternative<SmallVector>(to)) return dimension(to) <= static_cast<int>(positionOf(from).size());
    return from.index() == to.index();
  }

  /// A measurement that involves both: a relative pose, an observation, or a difference of positions. A `sure` one is
  /// no outlier and has no loss.
  std::unique_ptr<const JacobianFactor> between(VariableId a, VariableId b, bool sure) {
    const Value &from = truth(a), &to = truth(b);
    if (std::holds_alternative<SE3>(from) && std::holds_alternative<SE3>(to)) return betweenInSpace(a, b, sure);
    if (std::holds_alternative<SE2>(from) && std::holds_alternative<SE2>(to)) return betweenInPlane(a, b);
    const bool observation = !std::holds_alternative<SmallVector>(from) && std::holds_alternative<SmallVector>(to) &&
                             dimension(to) == static_cast<int>(positionOf(from).size());
    if (observation) {
      const Value seen = PointObservation::seen(from, std::get<SmallVector>(to));
      return std::make_unique<PointObservation>(a, b, std::get<SmallVector>(disturbed(seen, 1)), kSigma_m);
    }
    const auto size = std::min(positionOf(from).size(), positionOf(to).size());
    const Value difference = SmallVector(positionOf(to).head(size) - positionOf(from).head(size));
    return std::make_unique<PositionDifference>(a, b, std::get<SmallVector>(disturbed(difference, 1)), kSigma_m);
  }

  /// An encounter over three poses in space.
  std::unique_ptr<const JacobianFactor> encounter(VariableId x, VariableId a, VariableId z) {
    const SE3 seen = space(x).inverse() * space(a) * space(z);
    return std::make_unique<CameraEncounterFactor>(std::array{x, a, z}, CameraEncounterModel{measured(seen, loss_)},
                                                   poseNoise(1, loss_));
  }
  bool isSpace(VariableId v) const { return std::holds_alternative<SE3>(truth(v)); }

  Noise& noise() { return noise_; }
  /// A number uniform in [0, n).
  std::size_t below(std::size_t n) {
    return std::min(static_cast<std::size_t>(noise_.uniform(0, static_cast<double>(n))), n - 1);
  }

 private:
  SE3 space(VariableId v) const { return std::get<SE3>(truth(v)); }

  /// Standard deviations of a measurement of the value.
  static SmallVector sigmaOf(const Value& value) {
    SmallVector sigma = SmallVector::Constant(dimension(value), kSigma_m);
    if (std::holds_alternative<SE3>(value)) sigma.tail<3>().setConstant(kSigma_rad);
    if (std::holds_alternative<SE2>(value)) sigma[2] = kSigma_rad;
    return sigma;
  }
  static PoseNoise poseNoise(double scale, RobustLoss loss = RobustLoss::kNone) {
    const Vector6d sigma = scale * sigmaOf(SE3{});
    return {.sqrt_information = sigma.cwiseInverse().asDiagonal(), .loss = loss, .loss_scale = 3};
  }

  Value disturbed(const Value& value, double scale) {
    SmallVector error = scale * sigmaOf(value);
    for (double& e : error) e = noise_.gaussian(e);
    return retract(value, error);
  }
  SE3 measured(const SE3& T, RobustLoss loss) {
    const bool outlier = loss != RobustLoss::kNone && below(10) == 0;
    return std::get<SE3>(disturbed(T, outlier ? 20 : 1));
  }

  /// Covariance far from singular, so that systems made of it are well conditioned.
  template <int N>
  Eigen::Matrix<double, N, N> correlatedNoise(const Eigen::Matrix<double, N, 1>& sigma) {
    Eigen::Matrix<double, N, N> covariance = randomCovariance<N>(noise_, sigma);
    covariance.diagonal() += 0.1 * sigma.cwiseAbs2();
    return covariance;
  }

  Value draw() {
    Kind kind = kind_;
    if (kind == Kind::kMixed) kind = kKinds[below(3)];
    Vector6d xi;
    for (int i = 0; i < 6; ++i) xi[i] = noise_.gaussian(i < 3 ? 3.0 : 0.7);
    if (kind == Kind::kSpace) return SE3::exp(xi);
    if (kind == Kind::kPlane) return SE2(noise_.uniform(-3.14, 3.14), xi.head<2>());
    return SmallVector(xi.head(1 + static_cast<Eigen::Index>(below(6))));
  }

  std::unique_ptr<const JacobianFactor> betweenInSpace(VariableId a, VariableId b, bool sure) {
    const SE3 T_a_b = space(a).inverse() * space(b);
    const RobustLoss loss = sure ? RobustLoss::kNone : loss_;
    if (below(2) == 0)
      return std::make_unique<MotionFactor>(std::array{a, b}, MotionModel{measured(T_a_b, loss)}, poseNoise(1, loss));
    const Matrix6d covariance = correlatedNoise<6>(Vector6d(sigmaOf(SE3{})));
    return std::make_unique<RelativePoseFactorSE3>(a, b, T_a_b * SE3::exp(noise_.correlated(covariance)),
                                                   inverse(covariance));
  }

  std::unique_ptr<const JacobianFactor> betweenInPlane(VariableId a, VariableId b) {
    const SE2 T_a_b = std::get<SE2>(truth(a)).inverse() * std::get<SE2>(truth(b));
    const Eigen::Matrix3d covariance = correlatedNoise<3>(Eigen::Vector3d(sigmaOf(SE2{})));
    return std::make_unique<RelativePoseFactorSE2>(a, b, T_a_b * SE2::exp(noise_.correlated(covariance)),
                                                   Eigen::Matrix3d(covariance.inverse()));
  }

  Noise noise_;
  Kind kind_;
  RobustLoss loss_;
  std::vector<Value> truth_;
};

}  // namespace motorcade::test
