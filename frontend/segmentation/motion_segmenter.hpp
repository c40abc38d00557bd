#pragma once

#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/parameters.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"

namespace motorcade {

/// Connected components of the Delaunay graph over image points, without the edges that `belong_together` denies. Each
/// is ordered by index, and they are ordered by their first index. Points at the same pixel belong together without
/// being asked.
std::vector<std::vector<int>> cutDelaunayComponents(std::span<const Eigen::Vector2d> points_px,
                                                    const std::function<bool(int, int)>& belong_together);

/// Splits the scene into moving, static and unknown parts: connected components of the Delaunay graph over the image
/// points. An edge is cut where the scene flow of its ends differs by more than their uncertainty allows, or where they
/// are too far apart to be one vehicle. A moving component is split again where its parts do not keep their distance
/// (rigidParts). Points that surely move are split once more where they fell to a static part: a walker's velocity
/// differs from that of the house behind by little more than the tolerance. Stateless.
class MotionSegmenter {
 public:
  struct Params {
    double max_flow_chi2 = 11.3;    // of a scene-flow difference, 3 degrees of freedom: 99 %
    double max_gap_m = 2.0;         // between neighbors on one vehicle, beyond what their depth noise explains
    int min_points = 3;             // of a moving or static component
    double min_speed_mps = 1.0;     // of a moving component ...
    double min_significance = 4.5;  // ... and its speed in standard deviations
    double max_extent_m = 14.0;     // of a vehicle
  };
  MotionSegmenter(const Params& params, const StereoCamera& camera) : params_(requireValid(params)), camera_(camera) {}

  /// Labels the points that carry scene flow and lie off the ground, seen from a camera of this speed; returns the
  /// moving and the unknown components. `violates_geometry[i]` says that point i breaks the epipolar constraint or the
  /// flow-vector bound.
  std::vector<MotionComponent> operator()(std::vector<ScenePoint>& points, const std::vector<bool>& violates_geometry,
                                          const GroundPlane& ground, double camera_speed_mps) const;

  /// The edge predicate: true when two points may belong to one rigid body. `slack` scales the tolerance of velocities
  /// and the largest gap.
  bool belongTogether(const ScenePoint& a, const ScenePoint& b, double slack = 1) const;

  /// True when the scene flow of `point` is certain enough to be a vertex of the graph.
  bool isVertex(const ScenePoint& point) const;

 private:
  /// The points of a frame, which get labels, the road below them and the camera's speed.
  struct Scene {
    std::vector<ScenePoint>& points;
    const GroundPlane& ground;
    double camera_speed_mps;
  };
  using Bond = std::function<bool(int, int, double slack)>;
  std::vector<MotionComponent> split(const Scene& scene, std::span<const int> vertices, const Bond& belong_together,
                                     double slack = 1) const;
  std::vector<std::vector<int>> partsToSplit(const MotionComponent& component, const std::vector<ScenePoint>& points,
                                             double slack) const;
  MotionComponent describe(const Scene& scene, std::vector<int> members) const;
  PointLabel decide(const MotionComponent& component, const std::vector<ScenePoint>& points,
                    const GroundPlane& ground) const;
  bool isQueue(const MotionComponent& component, const std::vector<ScenePoint>& points) const;
  bool isTooLarge(const MotionComponent& component, const std::vector<ScenePoint>& points) const;
  bool isLikeAVehicle(const MotionComponent& component, const std::vector<ScenePoint>& points,
                      const GroundPlane& ground) const;

  Params params_;
  StereoCamera camera_;
};

std::vector<Parameter> parametersOf(MotionSegmenter::Params& params);

/// Splits vehicles side by side at the same speed, which are one component as the scene flow does not part them. Cuts
/// `members`, points of a moving `component`, at the widest gap across the travel while the pieces are wider than one
/// vehicle, `vehicle_width_m` plus their depth noise. Each piece has the component's velocity and its own centroid. A
/// component of one vehicle is returned as one piece.
std::vector<MotionComponent> splitAbreast(const MotionComponent& component, const std::vector<int>& members,
                                          const SceneMotion& scene, double vehicle_width_m);

}  // namespace motorcade
