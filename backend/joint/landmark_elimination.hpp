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
  std::vector<double> shakes_px;  // of each frame, as far as known: the views' disparities contain them; or none at all
  int count() const { return static_cast<int>(first_view.size()) - 1; }
  std::span<const LandmarkView> of(int landmark) const {
    return std::span(views).subspan(first_view[landmark], first_view[landmark + 1] - first_view[landmark]);
  }
};

/// Disparity error of one frame, to be added to its disparities. Its variance holds for the poses as they are taken to
/// be.
struct FrameShake {
  double px = 0, variance_px2 = 0;
};

/// Information of image measurements on the camera's motion around a body. The body's landmarks are eliminated (Schur
/// complement): with r_jk = Sigma^-1/2 [ y_jk + (offset + shake_k) e_d - pi(T_k l_j) ],
///   H = sum(A'A - A'B (B'B)^-1 B'A)
/// around the poses T_k = T_cam_body and the disparity offset at which they were linearized. The shakes of the frames
/// are eliminated next; their mean is zero. Landmarks follow when all poses move as one: H of such a step is zero, and
/// so is its product with g.
struct EliminatedLandmarks {
  FramePose pose = FramePose::kWorldCam;  // by whose steps
  std::vector<SE3> T_cam_body;            // of each frame
  double offset_px = 0;
  Quadratic system{};                                      // in (steps of the poses frame by frame, offset)
  std::vector<FrameShake> shakes;                          // of each frame; none where the cameras do not shake
  std::vector<std::optional<LandmarkEstimate>> estimates;  // of each landmark that could be fitted
};
EliminatedLandmarks eliminateLandmarks(const StereoCamera& camera, const LandmarkNoise& noise,
                                       const LandmarkViews& landmarks, FramePose pose, std::vector<SE3> T_cam_body,
                                       double offset_px);

}  // namespace motorcade
