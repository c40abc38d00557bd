#pragma once

#include <vector>

#include "backend/graph/factor.hpp"
#include "backend/joint/landmark_elimination.hpp"

namespace motorcade {

/// Eliminated landmarks as a factor on the poses from which their body was seen. It knows nothing but motions relative
/// to the last frame, D_k = T_cam(k)_body T_cam(last)_body^-1, and so stays what it is where everything moves as one:
///   e_k = log(D_k D_k(linearized)^-1),  cost = [S e; offset; 1]' system [S e; offset; 1]
/// S maps a displacement to a step of the pose variables.
class BundleFactor final : public InformationFactor {
 public:
  BundleFactor(std::vector<VariableId> poses, VariableId offset, EliminatedLandmarks landmarks);

  void linearize(std::span<const Value* const> values, Eigen::Ref<Eigen::MatrixXd> term) const override;
  const Quadratic* heldModel(std::span<const Value* const> values) const override;
  void gradient(std::span<const Value* const> values, Eigen::Ref<Eigen::VectorXd> g_c) const override;

  /// T_cam_body of the frames by the factor's variables.
  std::vector<SE3> posesFromCamera(std::span<const Value* const> values) const;
  const EliminatedLandmarks& landmarks() const { return landmarks_; }

 private:
  static double offset_px(std::span<const Value* const> values);

  /// Motions relative to the last frame against those at the linearization, and how they change with steps of the
  /// poses:
  ///   d(e_k) = J_k (d_k - J_last_k d_last)
  struct Displacement {
    Eigen::VectorXd e;  // [S log(D_k D_k(linearized)^-1) of each frame but the last; 0; offset]
    std::vector<Matrix6d> J, J_last;
  };
  Matrix6d block(int i, int j) const;
  Displacement displacement(std::span<const SE3> T_cam_body, double offset_px) const;
  /// [g; c] in displacements.
  Eigen::VectorXd gradientAt(const Eigen::VectorXd& e) const;
  void fillPoses(const Displacement& d, Eigen::Ref<Eigen::MatrixXd> term) const;

  int frames_;
  EliminatedLandmarks landmarks_;
  std::vector<SE3> D_inverse_;  // of D at the linearization
};

}  // namespace motorcade
