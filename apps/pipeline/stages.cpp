#include "apps/pipeline/stages.hpp"

#include <memory>
#include <stdexcept>
#include <string>

#include "apps/pipeline/configuration.hpp"
#include "apps/pipeline/restarting_backend.hpp"
#include "core/module.hpp"
#include "io/files/errors.hpp"

namespace motorcade {
namespace {

std::unique_ptr<Backend> makeBackend(const BackendParams& params, const StereoCamera& camera) {
  if (params.kind == BackendKind::kJoint) return std::make_unique<JointBackend>(params.joint, camera, params.window);
  const int motion_frames = params.window.motion_frames;
  if (params.kind == BackendKind::kFilter) return std::make_unique<FilterBackend>(params.filter, camera, motion_frames);
  if (params.kind == BackendKind::kFilterMap) return std::make_unique<MapFilterBackend>(params.filter, motion_frames);
  return std::make_unique<PoseGraphBackend>(params.pose_graph, camera, params.window);
}

std::shared_ptr<const FeaturePreparation> makePreparation(const FeaturePreparation::Params& params) try {
  return std::make_shared<const FeaturePreparation>(params);
} catch (const ModuleError& error) {  // the detector's
  throw UsageError(error.what());
}

/// Throws where an image is missing or its size differs from the camera's.
void requireImages(const StereoFrame& frame, const StereoCamera& camera) {
  const auto require = [&](const Image& image, const std::string& side) {
    if (image.empty()) throw std::invalid_argument("the " + side + " image is missing");
    if (image.width() == camera.width_px && image.height() == camera.height_px) return;
    throw std::invalid_argument("the " + side + " image has " + std::to_string(image.width()) + "x" +
                                std::to_string(image.height()) + " pixels, the camera says " +
                                std::to_string(camera.width_px) + "x" + std::to_string(camera.height_px));
  };
  require(frame.left, "left");
  require(frame.right, "right");
}

}  // namespace

/// The stages live behind shared pointers, because a std::function copies what it holds.
Stages makeStages(const PipelineConfig& config, const StereoCamera& camera) {
  const auto prepare = makePreparation(config.preparation);
  const auto stereo = std::make_shared<StereoMatcher>(config.stereo);
  const auto flow = std::make_shared<OpticalFlowTracker>(config.optical_flow);
  const auto motion = std::make_shared<SceneFlowSegmentation>(config.scene_flow_segmentation, camera);
  const auto tracking = std::make_shared<ObjectTracker>(config.tracking, camera);
  const auto shapes = std::make_shared<ObjectShapes>(config.shapes, camera);
  const std::shared_ptr<Backend> backend =
      std::make_shared<RestartingBackend>([params = config.backend, camera] { return makeBackend(params, camera); });
  return {.prepare =
              [prepare, camera](const StereoFramePtr& frame) {
                if (!frame->rejected()) requireImages(*frame, camera);
                return (*prepare)(frame);
              },
          .stereo_matching = [stereo](const FeaturesPtr& features) { return (*stereo)(features); },
          .optical_flow = [flow](const FeaturesPtr& features) { return (*flow)(features); },
          .scene_flow_segmentation = [motion](const StereoMatchesPtr& matches,
                                              const OpticalFlowPtr& tracks) { return (*motion)(matches, tracks); },
          .tracking = [tracking](const SceneMotionPtr& scene) { return (*tracking)(scene); },
          .incremental_optimization =
              [backend](const FrameMeasurementsPtr& measurements) { return (*backend)(measurements); },
          .object_shapes = [shapes](const ObjectShapes::Inputs& inputs,
                                    const EstimatesPtr& estimates) { return (*shapes)(inputs, estimates); },
          .finish = [backend, shapes] { return shapes->finish(backend->finish()); }};
}

}  // namespace motorcade
