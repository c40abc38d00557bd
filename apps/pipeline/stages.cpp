#include "apps/pipeline/stages.hpp"

#include <memory>

#include "apps/pipeline/pipeline_config.hpp"

namespace motorcade {
namespace {

std::unique_ptr<Backend> makeBackend(const BackendParams& params, const StereoCamera& camera) {
  if (params.kind == BackendKind::kJoint) return std::make_unique<JointBackend>(params.joint, camera);
  if (params.kind == BackendKind::kFilter) return std::make_unique<FilterBackend>(params.filter, camera);
  if (params.kind == BackendKind::kFilterMap) return std::make_unique<MapFilterBackend>(params.filter);
  return std::make_unique<PoseGraphBackend>(params.smoother, camera);
}

}  // namespace

/// The stages live behind shared pointers, because a std::function copies what it holds.
Stages makeStages(const PipelineConfig& config, const StereoCamera& camera) {
  const auto prepare = std::make_shared<FeaturePreparation>(config.preparation);
  const auto stereo = std::make_shared<StereoMatcher>(config.stereo);
  const auto flow = std::make_shared<OpticalFlowTracker>(config.optical_flow);
  const auto motion = std::make_shared<SceneFlowSegmentation>(config.scene_flow_segmentation, camera);
  const auto tracking = std::make_shared<ObjectTracker>(config.tracking, camera);
  const std::shared_ptr<Backend> backend = makeBackend(config.backend, camera);
  return {.prepare = [prepare](const StereoFramePtr& frame) { return (*prepare)(frame); },
          .stereo_matching = [stereo](const FeaturesPtr& features) { return (*stereo)(features); },
          .optical_flow = [flow](const FeaturesPtr& features) { return (*flow)(features); },
          .scene_flow_segmentation = [motion](const StereoMatchesPtr& matches,
                                              const OpticalFlowPtr& tracks) { return (*motion)(matches, tracks); },
          .tracking = [tracking](const SceneMotionPtr& scene) { return (*tracking)(scene); },
          .incremental_optimization =
              [backend](const FrameMeasurementsPtr& measurements) { return (*backend)(measurements); },
          .finish = [backend] { return backend->finish(); }};
}

}  // namespace motorcade
