#pragma once

#include <random>
#include <vector>

#include <Eigen/Dense>

#include "backend/factors.hpp"
#include "backend/incremental_solver.hpp"

namespace motorcade::test {

/// Seeded poses and noise.
class RandomPoses {
 public:
  explicit RandomPoses(std::uint64_t seed) : random_(seed) {}
  Vector6d noise(double sigma_m, double sigma_rad) {
    Vector6d xi;
    for (int i = 0; i < 6; ++i) xi[i] = normal_(random_) * (i < 3 ? sigma_m : sigma_rad);
    return xi;
  }
  SE3 pose(double sigma_m, double sigma_rad) { return SE3::exp(noise(sigma_m, sigma_rad)); }
  /// Uniform in [0, n).
  std::size_t below(std::size_t n) { return random_() % n; }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

inline PoseNoise isotropicNoise(double sigma_m, double sigma_rad) {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(sigma_m), Eigen::Vector3d::Constant(sigma_rad);
  return {.sqrt_information = sigma.cwiseInverse().asDiagonal()};
}

/// Feeds a solver with a camera and objects in random motion, a frame at a time.
class MultibodyGraph {
 public:
  struct Object {
    VariableId anchor;
    std::vector<VariableId> poses;
    std::vector<SE3> truth;  // z_i
    SE3 anchor_truth;
  };

  MultibodyGraph(IncrementalSolver& solver, std::uint64_t seed, int objects)
      : solver_(solver), random_(seed), objects_(static_cast<std::size_t>(objects)) {}

  void addFrame() {
    const SE3 before = camera_truth_.empty() ? SE3{} : camera_truth_.back();
    camera_truth_.push_back(camera_truth_.empty() ? SE3{} : before * forward() * random_.pose(0.1, 0.03));
    camera_.push_back(solver_.addVariable(camera_truth_.back() * random_.pose(0.05, 0.01)));
    const std::size_t n = camera_.size();
    if (n == 1)
      add<PriorFactor, 1>({camera_[0]}, PriorModel{}, 1e-2, 1e-3);
    else
      add<MotionFactor, 2>({camera_[n - 2], camera_[n - 1]}, MotionModel{noisy(before.inverse() * camera_truth_.back())}, kSigma_m,
                           kSigma_rad);
    for (std::size_t m = 0; m < objects_.size(); ++m) addObject(objects_[m], m);
  }

  const std::vector<VariableId>& camera() const { return camera_; }
  const std::vector<Object>& objects() const { return objects_; }
  RandomPoses& random() { return random_; }
  /// Forgets the oldest camera pose and object poses, and returns them.
  std::vector<VariableId> takeOldest() {
    std::vector<VariableId> oldest{camera_.front()};
    camera_.erase(camera_.begin());
    for (Object& object : objects_) {
      oldest.push_back(object.poses.front());
      object.poses.erase(object.poses.begin());
    }
    return oldest;
  }

 private:
  static constexpr double kSigma_m = 0.05, kSigma_rad = 0.01;
  static SE3 forward() { return {Eigen::Matrix3d::Identity(), {0, 0, 1}}; }
  SE3 noisy(const SE3& T) { return T * random_.pose(kSigma_m, kSigma_rad); }

  template <class FactorType, std::size_t N, class Model>
  void add(const std::array<VariableId, N>& variables, const Model& model, double sigma_m, double sigma_rad) {
    solver_.addFactor(std::make_unique<FactorType>(variables, model, isotropicNoise(sigma_m, sigma_rad)));
  }

  void addObject(Object& object, std::size_t number) {
    if (object.truth.empty()) {
      object.anchor_truth = SE3(expSO3({0, 0.3, 0}), {3.0 * static_cast<double>(number), 0, 10});
      object.truth.emplace_back();
      object.anchor = solver_.addVariable(object.anchor_truth * random_.pose(0.2, 0.05));
      add<PriorFactor, 1>({object.anchor}, PriorModel{solver_.pose(object.anchor)}, 100, 3);
    } else {
      object.truth.push_back(object.truth.back() * forward() * random_.pose(0.1, 0.03));
    }
    const SE3 z = object.truth.back();
    object.poses.push_back(solver_.addVariable(z * random_.pose(0.05, 0.01)));
    const std::size_t n = object.poses.size();
    if (object.truth.size() == 1) {
      add<PriorFactor, 1>({object.poses[0]}, PriorModel{}, 1e-2, 1e-3);
    } else {
      const SE3 motion = object.truth[object.truth.size() - 2].inverse() * z;
      add<MotionFactor, 2>({object.poses[n - 2], object.poses[n - 1]}, MotionModel{noisy(motion)}, kSigma_m, kSigma_rad);
    }
    if (n >= 3)
      add<SmoothMotionFactor, 3>({object.poses[n - 3], object.poses[n - 2], object.poses[n - 1]}, SmoothMotionModel{0.1, 0.1}, 2, 0.5);
    const SE3 seen = camera_truth_.back().inverse() * object.anchor_truth * z;
    add<CameraEncounterFactor, 3>({camera_.back(), object.anchor, object.poses.back()}, CameraEncounterModel{noisy(seen)}, 0.1, 0.02);
    if (number > 0) {
      const Object& other = objects_[number - 1];
      const SE3 relative = (other.anchor_truth * other.truth.back()).inverse() * object.anchor_truth * z;
      add<ObjectEncounterFactor, 4>({other.anchor, other.poses.back(), object.anchor, object.poses.back()},
                                    ObjectEncounterModel{noisy(relative)}, 0.2, 0.05);
    }
  }

  IncrementalSolver& solver_;
  RandomPoses random_;
  std::vector<Object> objects_;
  std::vector<VariableId> camera_;
  std::vector<SE3> camera_truth_;
};

/// Dense Gauss-Newton over the factors of a graph, written independently of the solver.
class DenseSystem {
 public:
  explicit DenseSystem(const FactorGraph& graph) : graph_(graph), variables_(graph.variables()) {
    for (const VariableId v : variables_) {
      offset_.resize(std::max(offset_.size(), static_cast<std::size_t>(v.value) + 1));
      offset_[static_cast<std::size_t>(v.value)] = size_;
      size_ += graph.sizeOf(v);
      values_.resize(offset_.size());
      values_[static_cast<std::size_t>(v.value)] = graph.estimate(v);
    }
  }

  /// The information matrix at the present values, and the gradient.
  std::pair<Eigen::MatrixXd, Eigen::VectorXd> linearized() const {
    Eigen::MatrixXd H = Eigen::MatrixXd::Zero(size_, size_);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(size_);
    for (const FactorId f : graph_.factors()) {
      std::vector<const Value*> values;
      std::vector<int> at;
      for (const VariableId v : graph_.factor(f).variables()) {
        values.push_back(&values_[static_cast<std::size_t>(v.value)]);
        for (int i = 0; i < graph_.sizeOf(v); ++i) at.push_back(offset(v) + i);
      }
      const Factor& factor = graph_.factor(f);
      Eigen::MatrixXd quadratic(factor.rows(), static_cast<Eigen::Index>(at.size()) + 1);
      factor.linearize(values, quadratic);
      if (factor.form() == Factor::Form::kJacobian) quadratic = (quadratic.transpose() * quadratic).eval();
      quadratic.triangularView<Eigen::StrictlyUpper>() = quadratic.transpose();
      const auto n = static_cast<Eigen::Index>(at.size());
      for (Eigen::Index i = 0; i < n; ++i) {
        g[at[static_cast<std::size_t>(i)]] += quadratic(n, i);
        for (Eigen::Index j = 0; j < n; ++j) H(at[static_cast<std::size_t>(i)], at[static_cast<std::size_t>(j)]) += quadratic(i, j);
      }
    }
    return {H, g};
  }

  void converge() {
    for (int i = 0; i < 50; ++i) {
      const auto [H, g] = linearized();
      const Eigen::VectorXd delta = -H.ldlt().solve(g);
      for (const VariableId v : variables_) {
        Value& value = values_[static_cast<std::size_t>(v.value)];
        value = retract(value, delta.segment(offset(v), graph_.sizeOf(v)));
      }
      if (delta.cwiseAbs().maxCoeff() < 1e-12) return;
    }
  }

  int offset(VariableId v) const { return offset_[static_cast<std::size_t>(v.value)]; }
  SE3 pose(VariableId v) const { return std::get<SE3>(values_[static_cast<std::size_t>(v.value)]); }

 private:
  const FactorGraph& graph_;
  std::vector<VariableId> variables_;
  std::vector<int> offset_;
  std::vector<Value> values_;
  int size_ = 0;
};

}  // namespace motorcade::test
