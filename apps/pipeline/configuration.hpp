#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "apps/pipeline/pipeline.hpp"
#include "backend/make_backend.hpp"
#include "frontend/features/feature_preparation.hpp"
#include "frontend/tracking/object_tracker.hpp"
#include "frontend/matching/optical_flow.hpp"
#include "frontend/segmentation/scene_motion_estimator.hpp"
#include "frontend/matching/stereo_matcher.hpp"

namespace motorcade {

/// Every parameter of a run. Keys of the configuration file follow the folders: `frontend.optical_flow.max_tracks`.
struct PipelineConfig {
  PipelineParams pipeline;
  FeaturePreparation::Params preparation;
  StereoMatcher::Params stereo;
  OpticalFlowTracker::Params optical_flow;
  SceneMotionEstimator::Params scene_motion;
  ObjectTracker::Params tracking;
  BackendParams backend;
};

/// Sets what the TOML text names and leaves the rest. Throws UsageError naming file, line, key and the mend. `backend = "filter"`
/// is short for `backend.kind = "filter"`.
void applyToml(PipelineConfig& config, std::string_view toml, const std::string& file_name);
/// The same for a file.
void applyFile(PipelineConfig& config, const std::filesystem::path& file);
/// The same for one `key=value`; the quotes around a string may be missing.
void applyAssignment(PipelineConfig& config, const std::string& assignment);

/// All parameters in force, with their ranges as comments; `applyToml` reads it back to the same values.
std::string toToml(const PipelineConfig& config);

}  // namespace motorcade
