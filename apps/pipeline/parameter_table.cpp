#include <utility>

#include "apps/pipeline/configuration.hpp"

namespace motorcade {
namespace {

Parameter backendKind(BackendParams& backend) {
  return choiceParameter<BackendKind>("kind", backend.kind,
                                      {{"joint", BackendKind::kJoint},
                                       {"pose_graph", BackendKind::kPoseGraph},
                                       {"filter", BackendKind::kFilter},
                                       {"filter_map", BackendKind::kFilterMap}},
                                      "joint is the most exact; pose_graph is the paper's graph, filter its baseline, "
                                      "filter_map that on averaged maps of the objects");
}

}  // namespace

std::vector<ConfigurationKey> parameterTable(PipelineConfig& config) {
  std::vector<ConfigurationKey> table;
  const auto add = [&](const std::string& section, std::vector<Parameter> parameters) {
    for (Parameter& parameter : parameters) table.push_back({section, std::move(parameter)});
  };
  auto& segmentation = config.scene_flow_segmentation;
  add("input", parametersOf(config.input));
  add("calibration", parametersOf(config.backend.window.calibration));
  add("pipeline", parametersOf(config.pipeline));
  add("frontend", parametersOf(config.preparation));
  add("frontend.corners", parametersOf(config.preparation.corners));
  add("frontend.sift", parametersOf(config.preparation.sift));
  add("frontend.stereo", parametersOf(config.stereo));
  add("frontend.optical_flow", parametersOf(config.optical_flow));
  add("frontend.circular_matching", parametersOf(segmentation.circular_matching));
  add("frontend.disparity_offset", parametersOf(segmentation.disparity_offset));
  add("frontend.ego_motion", parametersOf(segmentation.ego_motion));
  add("frontend.point_tracks", parametersOf(segmentation.point_tracks));
  add("frontend.scene_flow", parametersOf(segmentation.point_tracks.scene_flow));
  add("frontend.ground_plane", parametersOf(segmentation.ground_plane));
  add("frontend.segmentation", parametersOf(segmentation.segmenter));
  add("frontend.tracking", parametersOf(config.tracking));
  add("frontend.shapes", parametersOf(config.shapes));
  add("backend", {backendKind(config.backend)});
  add("backend", parametersOf(config.backend.window));
  add("backend", parametersOf(config.backend.pose_graph));
  add("backend.joint", parametersOf(config.backend.joint));
  return table;
}

}  // namespace motorcade
