#include "apps/bridge/result_publisher.hpp"

#include "apps/bridge/messages/detections.hpp"
#include "apps/bridge/messages/diagnostics.hpp"
#include "apps/bridge/messages/tracked_objects.hpp"
#include "apps/bridge/messages/vehicle_result.hpp"

namespace motorcade {

ResultPublisher::ResultPublisher(DdsPublisher& out, const Params& params)
    : out_(out), params_(params), markers_({.frame_id = params.ids.world, .lifetime_s = params.marker_lifetime_s}) {}

void ResultPublisher::publish(const Result& result) {
  const auto& [world, child] = params_.ids;
  const Result seen = seenFromVehicle(result, params_.T_child_cam);
  const std::int64_t first_stamp_ns = first_stamp_ns_.value_or(seen.stamp_ns);
  const auto wanted = [this](Topic topic) { return out_.publishes(topic); };
  if (wanted(Topic::kPose)) out_.publish(poseStampedOf(seen, params_.ids));
  if (wanted(Topic::kOdometry)) out_.publish(odometryOf(seen, params_.ids));
  if (wanted(Topic::kMarkers)) out_.publish(markers_(seen));
  if (wanted(Topic::kTrackedObjects)) out_.publish(trackedObjectsOf(seen, world, first_stamp_ns));
  if (wanted(Topic::kDetections)) out_.publish(detectionsOf(seen, child, first_stamp_ns));
  if (wanted(Topic::kDiagnostics)) out_.publish(diagnosticsOf(seen, params_.drive));
  if (wanted(Topic::kTf)) out_.publish(transformStampedOf(seen, params_.ids));
  first_stamp_ns_ = first_stamp_ns;
}

}  // namespace motorcade
