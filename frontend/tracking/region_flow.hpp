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

/// Scene flow of what an instance label shows as a whole. It is looked for in the frames before by its brightness in
/// both images. A point at rest and one that moves are then fitted to where it was, as to any scene point.
class RegionFlow {
 public:
  /// `past` outlives it.
  RegionFlow(const LookBack& past, const StereoCamera& camera) : past_(past), camera_(camera), estimate_({}, camera) {}

  /// The flow, and for how long it was seen.
  struct Seen {
    SceneFlow flow;
    double duration_s = 0;
  };
  /// Flow of the region's upper part; `disparity_px` is that of its points. Empty where it is found in too few frames.
  std::optional<Seen> operator()(const InstanceRegion& region, double disparity_px, const SceneMotion& scene,
                                 const SE3& T_world_cam) const;

 private:
  /// Pixels of a region, from its middle.
  struct Pixels {
    Eigen::Vector2d middle_px = Eigen::Vector2d::Zero();
    std::vector<Eigen::Vector2f> offsets_px;
  };
  static Pixels pixelsOf(const InstanceRegion& region, const InstanceLabels& labels);
  /// Place where the region is looked for, and how much larger it is seen there than now.
  struct Guess {
    Eigen::Vector3d uvd_px;
    double scale = 1;
    int radius_px = 0;  // columns each way
  };
  std::optional<PointObservation> observe(const RegionTemplate& now, const Pixels& pixels, const Features& there,
                                          const Guess& guess) const;
  std::optional<SceneFlow> fit(const std::vector<PointObservation>& newest_first,
                               const std::vector<const LookBack::PastScene*>& scenes, const SceneMotion& scene,
                               const SE3& T_world_cam) const;

  const LookBack& past_;
  StereoCamera camera_;
  SceneFlowEstimator estimate_;
};

}  // namespace motorcade
