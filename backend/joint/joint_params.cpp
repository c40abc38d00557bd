#include "backend/joint/joint_params.hpp"

namespace motorcade {

std::vector<Parameter> parametersOf(JointParams& params) {
  return {numberParameter("track_frames", params.track_frames, {3, 30},
                          "longer tracks tell more of slow motion, at the square of the cost"),
          numberParameter("max_static_landmarks", params.max_static_landmarks, {50, 2000},
                          "more are more exact, at proportional cost"),
          numberParameter("offset_sigma_px", params.offset_sigma_px, {0, 5},
                          "how far the disparities of a rig that is not calibrated may be off; 0 trusts every rig"),
          numberParameter("point_half", params.point_half, {0, 2},
                          "1 and 2 use one half of the points each, to see how far both agree; 0 uses all")};
}

BodyPoints::Params pointParams(const JointParams& params, const StereoCamera& camera, int max_views,
                               int max_landmarks) {
  return {.max_views = max_views,
          .max_landmarks = max_landmarks,
          .half = params.point_half,
          .image_width_px = camera.width_px,
          .image_height_px = camera.height_px};
}

}  // namespace motorcade
