#pragma once

#include <vector>

#include "backend/graph/factor.hpp"
#include "backend/joint/landmark.hpp"

namespace motorcade {

/// Landmarks of one body with their views: landmark i has views [first_view[i], first_view[i + 1]), oldest first.
struct LandmarkViews {
  std::vector<LandmarkView> views;
  std::vector<int> first_view{0};
  std::vector<std::optional<LandmarkEstimate>> before;  // of each landmark, or none at all
  int count() const { return static_cast<int>(first_view.size()) - 1; }
  std::span<const LandmarkView> of(int landmark) const {
    return std::span(views).subspan(first_view[landmark], first_view[landmark + 1] - first_view[landmark]);
  }
};

/// Sums of squared whitened residuals, and how many the landmarks' own unknowns leave: equal where the noise is as
/// claimed.
struct ResidualLevels {
  double uv_sum = 0, uv_count = 0, d_sum = 0, d_count = 0;
  /// Sum of the squares of what the residuals in one half of the image and in one frame add up to: as much as the sums
  /// above where they are independent, and more where they have causes in common, as errors of the rectification are.
  double common_sum = 0;
  double successive_sum = 0;  // of the products of residuals of a landmark's successive views
};

/// What image measurements of one body say of the camera's motion around it, its landmarks eliminated (Schur
/// complement): with r_jk = Sigma^-1/2 [ y_jk + offset e_d - pi(T_k l_j) ],
///   H = sum(A'A - A'B (B'B)^-1 B'A)
/// around the poses T_k = T_cam_body and the disparity offset at which they were linearized. Poses that all move as one
/// leave it as it is, as the landmarks follow: H of such a step is zero, and so is its product with g.
struct EliminatedLandmarks {
  FramePose pose = FramePose::kWorldCam;  // by whose steps
  std::vector<SE3> T_cam_body;            // of each frame
  double offset_px = 0;
  Quadratic system{};  // in (steps of the poses frame by frame, offset)
  ResidualLevels levels;
  std::vector<std::optional<LandmarkEstimate>> estimates;  // of each landmark that could be fitted
};
EliminatedLandmarks eliminateLandmarks(const StereoCamera& camera, const LandmarkNoise& noise,
                                       const LandmarkViews& landmarks, FramePose pose, std::vector<SE3> T_cam_body,
                                       double offset_px);

/// Eliminated landmarks as a factor on the poses from which their body was seen. It knows nothing but motions relative
/// to the last frame, D_k = T_cam(k)_body T_cam(last)_body^-1, and so stays what it is where everything moves as one:
///   e_k = log(D_k D_k(linearized)^-1),  cost = [S e; offset; 1]' system [S e; offset; 1]
/// where S makes steps of the poses of them.
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
