#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/messages.hpp"

/// Messages between the stages of the front-end, in the order in which they arise. Pixels are of the full-size left
/// image.
namespace motorcade {

/// An image at full, half, quarter, ... size. Pixel (x, y) of level k lies over (2^k x + (2^k - 1)/2, ...) of level 0.
struct ImagePyramid {
  std::vector<Image> levels;
};

/// A point worth following.
struct Corner {
  float u_px = 0, v_px = 0;
  float score = 0;
};

using SiftDescriptor = std::array<float, 128>;

/// A prepared stereo pair: what stereo matching and optical flow both need.
struct Features {
  StereoFramePtr frame;
  ImagePyramid left, right;     // empty when the frame is rejected
  std::vector<Corner> corners;  // of the left image, spread over a grid
  /// Descriptors of `corners`, and the right image's points with theirs; only with the SIFT detector.
  std::vector<SiftDescriptor> descriptors;
  std::vector<Corner> right_corners;
  std::vector<SiftDescriptor> right_descriptors;
};
using FeaturesPtr = std::shared_ptr<const Features>;

/// Disparity of a left pixel, with the standard deviation that the patch alignment predicts.
struct StereoMatch {
  float disparity_px = 0;
  float sigma_px = 0;
};

/// One match per corner. A match without a standard deviation is exact to a whole pixel; `refinedMatch` tells more of
/// it.
struct StereoMatches {
  FeaturesPtr features;
  std::vector<std::optional<StereoMatch>> of_corner;
  double min_disparity_px = 0;  // of refined matches
};
using StereoMatchesPtr = std::shared_ptr<const StereoMatches>;

/// A scene point in this frame's left image.
struct FlowObservation {
  PointId point;
  float u_px = 0, v_px = 0;
  float sigma_px = 0;  // of each coordinate
  int age = 1;         // number of frames in which it was observed, this one included
  int corner = -1;     // index in `Features::corners` of a point that starts in this frame, -1 of any other
};

/// Observations ordered by point id: of points followed from the previous frame, and of points that start here.
struct OpticalFlow {
  FeaturesPtr features;
  std::vector<FlowObservation> observations;
};
using OpticalFlowPtr = std::shared_ptr<const OpticalFlow>;

/// Position and velocity of a point in the world, estimated from its track over several frames. Coordinates are in the
/// camera's present frame; velocities are relative to the world, in the axes of that frame.
struct SceneFlow {
  Eigen::Vector3d p_cam;
  Eigen::Vector3d velocity_mps;
  Eigen::Matrix<double, 6, 6> covariance;  // of (p_cam, velocity)
  double static_chi2 = 0;                  // misfit of a point at rest ...
  double moving_chi2 = 0;                  // ... and of one with constant velocity
  int observations = 0;
};

enum class PointLabel { kUnknown, kStatic, kGround, kMoving };

/// A point observed in all four images, or one that starts in this stereo pair.
struct ScenePoint {
  PointId point;
  Eigen::Vector3d uvd_px;
  Eigen::Vector3d sigma_px;  // independent standard deviations of u, v, d
  int age = 1;
  bool ambiguous = false;   // its patch is also found where a point at rest would be: its motion proves nothing
  bool ego_inlier = false;  // agrees with the camera's motion over a static world since the previous frame
  PointLabel label = PointLabel::kUnknown;
  std::uint16_t instance = 0;  // the body that it lies on, as the pair's instance labels tell; 0: they do not
  std::optional<SceneFlow> flow;
};

/// Plane of the road: normal . p_cam = height_m, the normal pointing down in the image (away from the sky).
struct GroundPlane {
  Eigen::Vector3d normal_cam{0, 1, 0};
  double height_m = 1.65;  // of the camera above the plane
  double heightOf_m(const Eigen::Vector3d& p_cam) const { return height_m - normal_cam.dot(p_cam); }
};

/// A connected component of the cut Delaunay graph.
struct MotionComponent {
  std::vector<int> points;  // indices into `SceneMotion::points`
  PointLabel label = PointLabel::kUnknown;
  Eigen::Vector3d centroid_cam = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_mps = Eigen::Vector3d::Zero();
  Eigen::Matrix3d velocity_covariance = Eigen::Matrix3d::Identity();
};

/// The camera's motion and the moving parts of the scene.
struct SceneMotion {
  FrameHead head;
  Odometry odometry;
  double camera_speed_mps = 0;  // since the frame before; 0 where there is none
  int ego_inliers = 0;
  double disparity_offset_px = 0;  // true minus measured disparity; the points' disparities contain it
  GroundPlane ground;
  std::vector<ScenePoint> points;               // ordered by point id
  std::vector<MotionComponent> components;      // moving and unknown ones; the static rest is not listed
  FeaturesPtr features;                         // the stereo pair
  std::optional<OwnVehicleView> own_vehicle{};  // as found up to this frame
  std::optional<VehicleSensors> vehicle_sensors{};
};
using SceneMotionPtr = std::shared_ptr<const SceneMotion>;

}  // namespace motorcade
