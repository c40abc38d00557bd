#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/object_pool.hpp"
#include "core/parameters.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/geometry/point_grid.hpp"
#include "frontend/image/patch_alignment.hpp"
#include "frontend/matching/ambiguous_texture.hpp"
#include "frontend/messages.hpp"
#include "frontend/motion/disparity_offset.hpp"
#include "frontend/motion/ego_motion.hpp"
#include "frontend/motion/ground_plane.hpp"
#include "frontend/motion/point_track.hpp"
#include "frontend/motion/scene_flow.hpp"
#include "frontend/segmentation/motion_segmenter.hpp"

namespace motorcade {

/// The stage `motion`: from stereo matches and optical flow to the camera's motion and the moving parts of the scene.
///   1. closes the circle of four images: the disparity of each followed point, predicted from the frame before and
///   verified in R_t
///   2. ego-motion from the static world   3. scene flow of every point over its track   4. ground plane   5. motion
///   segmentation
/// Call in frame order: it remembers the tracks and the camera's recent path.
class SceneFlowSegmentation {
 public:
  struct Params {
    DisparityParams disparity;
    double neighbor_px = 10;  // a track without disparity tries that of a corner this near
    double unpredicted_search =
        0.15;  // extra search for disparity, as a fraction of it, while the camera's motion is unknown
    double sigma_flow_px = 0.25;  // standard deviations are never below these
    double sigma_disparity_px = 0.25;
    int max_missed_frames = 2;  // a point may be without disparity so long before its track is dropped
    double static_chi2_per_dof =
        3.0;  // a track that fits a point at rest this well enters the ego-motion with its fitted position
    double repeat_check_chi2 =
        16;  // points that fit motion by so much better than rest are checked for repeated texture
    RepeatedTextureParams repeated_texture;
    double max_ground_noise_m = 0.3;  // a point's height above the road may be off by this much of its depth noise
    double lost_sigma_m = 0.3, lost_sigma_rad = 0.02;  // of the predicted motion when the ego-motion is lost
    DisparityOffsetEstimator::Params disparity_offset;
    EgoMotionEstimator::Params ego_motion;
    SceneFlowEstimator::Params scene_flow;
    GroundPlaneEstimator::Params ground_plane;
    MotionSegmenter::Params segmenter;
  };
  SceneFlowSegmentation(const Params& params, const StereoCamera& camera);

  /// Both messages are of the same frame.
  SceneMotionPtr operator()(const StereoMatchesPtr& stereo, const OpticalFlowPtr& flow);

 private:
  /// A point of the current frame and, when it was followed here, its track so far.
  struct Sighted {
    FlowObservation flow;
    const PointTrack* track;               // null for a newborn point
    std::optional<StereoMatch> disparity;  // none: not found in the right image this time
  };

  std::vector<Sighted> closeCircle(const StereoMatches& stereo, const OpticalFlow& flow,
                                   const SE3& predicted_T_previous_now) const;
  std::optional<StereoMatch> firstDisparity(const StereoMatches& stereo, const PointGrid& corners,
                                            const FlowObservation& flow) const;
  std::optional<StereoMatch> verifyInRightImage(const Features& features, const FlowObservation& flow,
                                                const PointTrack& track, const SE3& predicted_T_now_previous) const;
  PoseObservation observe(const Sighted& sighted) const;
  /// Position of a track in the newest camera of the trail, with its covariance: the fitted one while it fits a point
  /// at rest, else the triangulated one.
  PoseObservation lastPosition(const PointTrack& track) const;
  std::vector<bool> estimateEgoMotion(const std::vector<Sighted>& sighted, const SE3& predicted, SceneMotion& motion);
  std::shared_ptr<SceneMotion> emptyMotion();
  void updateTracks(const std::vector<Sighted>& sighted, const FeaturesPtr& features);
  /// The track of a point whose disparity was found, with what its observations up to now tell.
  PointTrack extendTrack(const Sighted& sighted, const Image& now) const;
  bool isFoundAtRest(const Sighted& sighted, const Image& now) const;
  void fillPoints(const std::vector<Sighted>& sighted, const std::vector<bool>& inliers, SceneMotion& motion) const;
  void markGround(SceneMotion& motion, const std::vector<bool>& violates_geometry);
  void calibrateDisparity();
  bool violatesGeometry(const PointTrack& track) const;
  bool sightedNow(const PointTrack& track) const;
  SE3 predictMotion(Timestamp stamp) const;

  Params params_;
  StereoCamera camera_;
  DisparityOffsetEstimator disparity_offset_;
  EgoMotionEstimator ego_motion_;
  SceneFlowEstimator scene_flow_;
  GroundPlaneEstimator ground_plane_;
  MotionSegmenter segmenter_;

  ObjectPool<SceneMotion> motions_;
  std::vector<PointTrack> tracks_;          // ordered by point
  std::vector<PointTrack> updated_tracks_;  // of the frame before the last; its memory serves again
  FeaturesPtr previous_features_;           // empty at the start and after a rejected frame
  CameraTrail trail_;
  std::optional<SE3> last_motion_;  // T_previous_now of the last frame
  double last_dt_s_ = 0;
  int steady_frames_ = 0;  // see PredictedMotion
};

std::vector<Parameter> parametersOf(SceneFlowSegmentation::Params& params);

}  // namespace motorcade
