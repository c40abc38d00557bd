#pragma once

#include "apps/pipeline/pipeline_params.hpp"
#include "backend/filter/filter_backend.hpp"
#include "backend/filter/map_filter_backend.hpp"
#include "backend/joint/joint_backend.hpp"
#include "backend/pose_graph/pose_graph_backend.hpp"
#include "backend/window/window_params.hpp"
#include "frontend/features/feature_preparation.hpp"
#include "frontend/matching/optical_flow.hpp"
#include "frontend/matching/stereo_matcher.hpp"
#include "frontend/segmentation/scene_flow_segmentation.hpp"
#include "frontend/shape/object_shapes.hpp"
#include "frontend/tracking/object_tracker.hpp"
#include "io/images/image_limits.hpp"

namespace motorcade {

enum class BackendKind {
  kJoint,      // camera, objects and points in one estimate
  kPoseGraph,  // the paper: the incremental smoother over poses of camera and objects
  kFilter,     // the paper's baseline: chained odometry and one Kalman filter per object, on frame-to-frame motions
  kFilterMap,  // the same on the poses of the front-end's averaged maps of the objects
};

struct BackendParams {
  BackendKind kind = BackendKind::kJoint;
  WindowParams window;  // of both smoothing back-ends
  JointBackend::Params joint;
  PoseGraphBackend::Params pose_graph;
  FilterBackend::Params filter;
};

/// All parameters of a run, by stage. Those that a user may set have a key in the configuration file.
struct PipelineConfig {
  ImageLimits input;
  PipelineParams pipeline;
  FeaturePreparation::Params preparation;
  StereoMatcher::Params stereo;
  OpticalFlowTracker::Params optical_flow;
  SceneFlowSegmentation::Params scene_flow_segmentation;
  ObjectTracker::Params tracking;
  ObjectShapes::Params shapes;
  BackendParams backend;
};

}  // namespace motorcade
