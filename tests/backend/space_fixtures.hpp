#pragma once

#include <memory>

#include <Eigen/Cholesky>

#include "backend/factors/pose_factors.hpp"
#include "backend/graph/relative_pose_factor.hpp"
#include "tests/backend/random_graphs.hpp"

/// Graphs over each kind of variable, with the same words.
namespace motorcade::test {

/// Z = xj - xi, whitened.
class RelativeVectorFactor final : public JacobianFactor {
 public:
  RelativeVectorFactor(VariableId i, VariableId j, const Eigen::Vector3d& Z, const Eigen::Matrix3d& root)
      : JacobianFactor({i, j}, 3), Z_(Z), root_(root) {}
  void linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const override {
    term.leftCols<3>() = -root_;
    term.middleCols<3>(3) = root_;
    residual(values, term.col(6));
  }
  void residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const override {
    r = root_ * (std::get<SmallVector>(*values[1]) - std::get<SmallVector>(*values[0]) - Z_);
  }

 private:
  Eigen::Vector3d Z_;
  Eigen::Matrix3d root_;
};

class PriorVectorFactor final : public JacobianFactor {
 public:
  PriorVectorFactor(VariableId v, const Eigen::Vector3d& mean, const Eigen::Matrix3d& root)
      : JacobianFactor({v}, 3), mean_(mean), root_(root) {}
  void linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const override {
    term.leftCols<3>() = root_;
    residual(values, term.col(3));
  }
  void residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const override {
    r = root_ * (std::get<SmallVector>(*values[0]) - mean_);
  }

 private:
  Eigen::Vector3d mean_;
  Eigen::Matrix3d root_;
};

/// Rest of a factor when its residual is multiplied by A.
class ProjectedFactor final : public JacobianFactor {
 public:
  ProjectedFactor(std::unique_ptr<const JacobianFactor> whole, Eigen::MatrixXd A)
      : JacobianFactor({whole->variables().begin(), whole->variables().end()}, static_cast<int>(A.rows())),
        whole_(std::move(whole)),
        A_(std::move(A)) {}
  void linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const override {
    Eigen::MatrixXd all(whole_->rows(), term.cols());
    whole_->linearize(values, all);
    term = A_ * all;
  }
  void residual(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> r) const override {
    Eigen::VectorXd all(whole_->rows());
    whole_->residual(values, all);
    r = A_ * all;
  }

 private:
  std::unique_ptr<const JacobianFactor> whole_;
  Eigen::MatrixXd A_;
};

/// Poses in space.
struct Space3 {
  static constexpr int kSize = 6;
  static Value between(const Value& from, const Value& to) { return std::get<SE3>(from).inverse() * std::get<SE3>(to); }
  static Value moved(const Value& from, const SmallVector& xi) { return std::get<SE3>(from) * SE3::exp(xi); }
  static Value origin() { return SE3{}; }
  static std::unique_ptr<JacobianFactor> relative(VariableId i, VariableId j, const Value& Z, double weight = 1) {
    return std::make_unique<RelativePoseFactorSE3>(i, j, std::get<SE3>(Z), weight * Matrix6d::Identity());
  }
  static std::unique_ptr<JacobianFactor> prior(VariableId v, const Value& mean, double weight = 1) {
    return std::make_unique<PriorFactor>(std::array{v}, PriorModel{std::get<SE3>(mean)},
                                         PoseNoise{.sqrt_information = std::sqrt(weight) * Matrix6d::Identity()});
  }
};

/// Poses in the plane.
struct Space2 {
  static constexpr int kSize = 3;
  static Value between(const Value& from, const Value& to) { return std::get<SE2>(from).inverse() * std::get<SE2>(to); }
  static Value moved(const Value& from, const SmallVector& xi) { return std::get<SE2>(from) * SE2::exp(xi); }
  static Value origin() { return SE2{}; }
  static std::unique_ptr<JacobianFactor> relative(VariableId i, VariableId j, const Value& Z, double weight = 1) {
    return std::make_unique<RelativePoseFactorSE2>(i, j, std::get<SE2>(Z), weight * Eigen::Matrix3d::Identity());
  }
  static std::unique_ptr<JacobianFactor> prior(VariableId v, const Value& mean, double weight = 1) {
    return std::make_unique<PriorFactorSE2>(v, std::get<SE2>(mean), weight * Eigen::Matrix3d::Identity());
  }
};

/// Points.
struct Vectors {
  static constexpr int kSize = 3;
  static Value between(const Value& from, const Value& to) {
    return SmallVector(std::get<SmallVector>(to) - std::get<SmallVector>(from));
  }
  static Value moved(const Value& from, const SmallVector& step) {
    return SmallVector(std::get<SmallVector>(from) + step);
  }
  static Value origin() { return SmallVector(SmallVector::Zero(3)); }
  static std::unique_ptr<JacobianFactor> relative(VariableId i, VariableId j, const Value& Z, double weight = 1) {
    return std::make_unique<RelativeVectorFactor>(i, j, std::get<SmallVector>(Z),
                                                  std::sqrt(weight) * Eigen::Matrix3d::Identity());
  }
  static std::unique_ptr<JacobianFactor> prior(VariableId v, const Value& mean, double weight = 1) {
    return std::make_unique<PriorVectorFactor>(v, std::get<SmallVector>(mean),
                                               std::sqrt(weight) * Eigen::Matrix3d::Identity());
  }
};

}  // namespace motorcade::test
