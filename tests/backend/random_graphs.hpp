#pragma once

#include <random>
#include <vector>

#include "backend/factors/pose_factors.hpp"
#include "backend/solver/incremental_solver.hpp"

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
  /// A number uniform in [0, n).
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

  /// All camera encounters have the loss, if there is one, and one in eight of them is an outlier.
  MultibodyGraph(IncrementalSolver& solver, std::uint64_t seed, int objects, RobustLoss loss = RobustLoss::kNone)
      : solver_(solver), random_(seed), loss_(loss), objects_(static_cast<std::size_t>(objects)) {}

  void addFrame() {
    const SE3 before = camera_truth_.empty() ? SE3{} : camera_truth_.back();
    camera_truth_.push_back(camera_truth_.empty() ? SE3{} : before * forward() * random_.pose(0.1, 0.03));
    camera_.push_back(solver_.addVariable(camera_truth_.back() * random_.pose(0.05, 0.01)));
    const std::size_t n = camera_.size();
    if (n == 1)
      add<PriorFactor, 1>({camera_[0]}, PriorModel{}, 1e-2, 1e-3);
    else
      add<MotionFactor, 2>({camera_[n - 2], camera_[n - 1]},
                           MotionModel{noisy(before.inverse() * camera_truth_.back())}, kSigma_m, kSigma_rad);
    for (std::size_t m = 0; m < objects_.size(); ++m) addObject(objects_[m], m);
  }

  const std::vector<VariableId>& camera() const { return camera_; }
  const std::vector<Object>& objects() const { return objects_; }
  RandomPoses& random() { return random_; }
  /// Starts an object, which comes into view with the next frame.
  void startObject() { objects_.emplace_back(); }
  /// Forgets an object, and returns its variables.
  std::vector<VariableId> takeObject(std::size_t m) {
    std::vector<VariableId> variables = objects_[m].poses;
    variables.push_back(objects_[m].anchor);
    objects_.erase(objects_.begin() + static_cast<std::ptrdiff_t>(m));
    return variables;
  }
  /// Forgets the oldest camera pose and object poses, and returns them.
  std::vector<VariableId> takeOldest() {
    std::vector<VariableId> oldest{camera_.front()};
    camera_.erase(camera_.begin());
    for (Object& object : objects_) {
      if (object.poses.size() < 2) continue;  // the next frame hangs on the last
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
  void add(const std::array<VariableId, N>& variables, const Model& model, double sigma_m, double sigma_rad,
           RobustLoss loss = RobustLoss::kNone) {
    PoseNoise noise = isotropicNoise(sigma_m, sigma_rad);
    noise.loss = loss;
    noise.loss_scale = 3;  // of six dimensions: the norm is about 2.4
    solver_.addFactor(std::make_unique<FactorType>(variables, model, noise));
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
      add<MotionFactor, 2>({object.poses[n - 2], object.poses[n - 1]}, MotionModel{noisy(motion)}, kSigma_m,
                           kSigma_rad);
    }
    if (n >= 3)
      add<SmoothMotionFactor, 3>({object.poses[n - 3], object.poses[n - 2], object.poses[n - 1]},
                                 SmoothMotionModel{0.1, 0.1}, 2, 0.5);
    const SE3 seen = camera_truth_.back().inverse() * object.anchor_truth * z;
    const SE3 slip = loss_ != RobustLoss::kNone && random_.below(8) == 0 ? random_.pose(2, 0.3) : SE3{};
    add<CameraEncounterFactor, 3>({camera_.back(), object.anchor, object.poses.back()},
                                  CameraEncounterModel{noisy(seen) * slip}, 0.1, 0.02, loss_);
    if (number > 0) {
      const Object& other = objects_[number - 1];
      const SE3 relative = (other.anchor_truth * other.truth.back()).inverse() * object.anchor_truth * z;
      add<ObjectEncounterFactor, 4>({other.anchor, other.poses.back(), object.anchor, object.poses.back()},
                                    ObjectEncounterModel{noisy(relative)}, 0.2, 0.05);
    }
  }

  IncrementalSolver& solver_;
  RandomPoses random_;
  RobustLoss loss_;
  std::vector<Object> objects_;
  std::vector<VariableId> camera_;
  std::vector<SE3> camera_truth_;
};

}  // namespace motorcade::test
