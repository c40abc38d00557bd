#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/instance_labels.hpp"
#include "core/messages.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/image/region_template.hpp"
#include "frontend/messages.hpp"
#include "frontend/motion/point_track.hpp"
#include "frontend/motion/scene_flow.hpp"
#include "frontend/tracking/look_back.hpp"

namespace motorcade {

/// Place of an instance label in the left image.
struct InstanceRegion {
  std::uint16_t label;
  Box box;
};

/// Upper part of a region, which of a person is trunk and head: legs swing.
Box upperPart(const Box& region);

/// Region of each label, ordered by label. Takes one look at each pixel.
std::vector<InstanceRegion> regionsOf(const InstanceLabels& labels);

/// Pixels of what may be one body, from their middle in the left image.
struct RegionPixels {
  Eigen::Vector2d middle_px = Eigen::Vector2d::Zero();
  std::vector<Eigen::Vector2f> offsets_px;
  int step_px = 1;  // between neighbors: of large regions they are farther apart
};

/// Pixels of a region's upper part that have its label, with a margin.
RegionPixels pixelsOf(const InstanceRegion& region, const InstanceLabels& labels);
/// Pixels of a box, so many at most.
RegionPixels pixelsIn(const Box& box, int most);
/// Pixels of a box in which stereo finds a disparity [px].
RegionPixels pixelsAtDepth(const Box& box, double disparity_px, const SceneMotion& scene);

/// Scene flow of a region as a whole. It is looked for in the frames before by its brightness in both images. A point
/// at rest and one that moves are then fitted to where it was, as to any scene point.
class RegionFlow {
 public:
  /// `past` outlives it.
  RegionFlow(const LookBack& past, const StereoCamera& camera) : past_(past), camera_(camera), estimate_({}, camera) {}

  /// The flow, and for how long it was seen.
  struct Seen {
    SceneFlow flow;
    double duration_s = 0;
    double not_static_chi2 = 0;  // by which moving explains better than resting how bright the pixels were
  };
  /// Flow of a region; `disparity_px` is that of its points. Empty where it is found in too few frames, or in less than
  /// a share of those that are looked at.
  std::optional<Seen> operator()(const RegionPixels& region, double disparity_px, const SceneMotion& scene,
                                 const SE3& T_world_cam, double least_found) const;
  /// True for a region that looked the same in the frame before, where it was if it rests.
  bool rests(const RegionPixels& region, double disparity_px, const SceneMotion& scene, const SE3& T_world_cam) const;

 private:
  /// Place where the region is looked for, and how much larger it is seen there than now.
  struct Guess {
    Eigen::Vector3d uvd_px;
    double scale = 1;
    int radius_px = 0;  // columns each way
  };
  std::optional<PointObservation> observe(const RegionTemplate& now, const RegionPixels& pixels, const Features& there,
                                          const Guess& guess) const;
  double nccAtRest(const RegionTemplate& now, const Eigen::Vector3d& uvd_px, const LookBack::PastScene& past,
                   const SE3& T_then_now, double enough = 1) const;
  std::optional<SceneFlow> fit(const std::vector<PointObservation>& newest_first,
                               const std::vector<const LookBack::PastScene*>& scenes, const SceneMotion& scene,
                               const SE3& T_world_cam) const;

  const LookBack& past_;
  StereoCamera camera_;
  SceneFlowEstimator estimate_;
};

}  // namespace motorcade
