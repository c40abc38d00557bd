#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "apps/pipeline/pipeline_params.hpp"
#include "backend/filter/filter_backend.hpp"
#include "backend/filter/map_filter_backend.hpp"
#include "backend/joint/joint_backend.hpp"
#include "backend/pose_graph/pose_graph_backend.hpp"
#include "backend/window/window_params.hpp"
#include "core/parameters.hpp"
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

/// One key of the configuration file: `key()` is `frontend.optical_flow.max_tracks`.
struct ConfigurationKey {
  std::string section;
  Parameter parameter;

  std::string key() const { return section + "." + parameter.name; }
};

/// Every key, bound to the members of `config`, under its section of the file. Sections are contiguous.
std::vector<ConfigurationKey> parameterTable(PipelineConfig& config);

/// Sets the parameters that the TOML text names and leaves the others. Throws UsageError naming file, line and key, and
/// how to fix it. `backend = "filter"` is short for `backend.kind = "filter"`.
void applyToml(PipelineConfig& config, std::string_view toml, const std::string& file_name);
/// The same for a file.
void applyFile(PipelineConfig& config, const std::filesystem::path& file);
/// Sets one parameter from `key=value`; the quotes around a string may be missing.
void applyAssignment(PipelineConfig& config, const std::string& assignment);

/// All parameters in force, each with its purpose and range as a comment; `applyToml` reads it back to the same values.
std::string toToml(const PipelineConfig& config);

}  // namespace motorcade
