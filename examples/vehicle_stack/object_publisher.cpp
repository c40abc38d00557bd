#include "object_publisher.hpp"

#include <array>
#include <utility>

#include "json_line.hpp"

namespace vehicle_stack {
namespace {

using motorcade::Result;

const char* nameOf(Result::Status status) {
  switch (status) {
    case Result::Status::kGood:
      return "good";
    case Result::Status::kLost:
      return "lost";
    case Result::Status::kRejected:
      return "rejected";
  }
  return "rejected";
}

const char* nameOf(Result::Cause cause) {
  constexpr std::array kNames{"none",   "after_gap", "few_points",   "no_points", "unlinked",
                              "failed", "unusable",  "out_of_order", "too_late"};
  static_assert(kNames.size() == static_cast<std::size_t>(Result::Cause::kTooLate) + 1);
  return kNames[static_cast<std::size_t>(cause)];
}

const char* nameOf(Result::State state) {
  switch (state) {
    case Result::State::kMoving:
      return "moving";
    case Result::State::kStopped:
      return "stopped";
    case Result::State::kPredicted:
      return "predicted";
  }
  return "predicted";
}

const char* nameOf(Result::Kind kind) {
  switch (kind) {
    case Result::Kind::kUnknown:
      return "unknown";
    case Result::Kind::kCar:
      return "car";
    case Result::Kind::kLargeVehicle:
      return "large_vehicle";
    case Result::Kind::kTwoWheeler:
      return "two_wheeler";
    case Result::Kind::kPedestrian:
      return "pedestrian";
  }
  return "unknown";
}

template <std::size_t kSize>
void addOrNull(JsonLine& line, const char* key, const std::optional<Matrix<kSize, kSize>>& matrix) {
  if (matrix) {
    line.add(key, matrix->values);
  } else {
    line.addNull(key);
  }
}

void addMotion(JsonLine& line, const VehicleMotionSample& motion) {
  line.add("ego_velocity", motion.velocity.values).add("ego_velocity_covariance", motion.covariance.values);
}

void addAcceleration(JsonLine& line, const std::optional<Result::Acceleration>& acceleration) {
  if (!acceleration) {
    line.addNull("acceleration_mps2");
    return;
  }
  line.add("acceleration_mps2", acceleration->along_mps2);
  line.add("acceleration_sigma_mps2", acceleration->along_sigma_mps2);
  line.add("yaw_acceleration_radps2", acceleration->yaw_radps2);
  line.add("yaw_acceleration_sigma_radps2", acceleration->yaw_sigma_radps2);
}

void addBox(JsonLine& line, const std::optional<VehicleObject::Box>& box) {
  if (!box) {
    line.addNull("box_center_m");
    return;
  }
  line.add("box_center_m", box->center_m.values).add("box_size_m", box->size_m.values);
  line.add("box_size_sigma_m", box->size_sigma_m.values);
  addOrNull(line, "box_center_covariance", box->center_covariance);
}

}  // namespace

ObjectPublisher::ObjectPublisher(const VehicleFrame& frame, std::chrono::milliseconds valid_for, Publish publish)
    : frame_(frame), valid_for_ms_(valid_for.count()), publish_(std::move(publish)) {}

void ObjectPublisher::publish(const Result& result, Level level) {
  const Trust trust = trustIn(result, level);
  JsonLine line("frame");
  line.add("frame", result.frame).add("stamp_ns", result.stamp_ns).add("valid_for_ms", valid_for_ms_);
  line.add("trust", vehicle_stack::nameOf(trust)).add("level", vehicle_stack::nameOf(level));
  line.add("status", nameOf(result.status)).add("cause", nameOf(result.cause)).add("problem", result.problem);
  line.add("segment", std::int64_t{result.segment}).add("latency_ms", result.latency_ms);
  line.add("dropped_before", std::int64_t{result.dropped_before});
  addMotion(line, frame_.motion(result));
  line.add("objects", static_cast<std::int64_t>(result.objects.size()));
  publish_(line.text());
  for (const auto& object : result.objects) publishObject(result, object, trust);

  const std::scoped_lock lock(mutex_);
  published_.clear();
  if (trust != Trust::kNone)
    for (const auto& object : result.objects) published_.push_back(object.id);
}

void ObjectPublisher::publishObject(const Result& result, const Result::Object& object, Trust in_frame) {
  const VehicleObject seen = frame_.object(result, object);
  JsonLine line("object");
  line.add("frame", result.frame).add("stamp_ns", result.stamp_ns).add("valid_for_ms", valid_for_ms_);
  line.add("id", object.id).add("trust", vehicle_stack::nameOf(trustIn(object, in_frame)));
  line.add("state", nameOf(object.state)).add("kind", nameOf(object.kind));
  line.add("kind_probability", object.kind_probability);
  line.add("existence_probability", object.existence_probability).add("age_s", object.age_s);
  line.add("points", std::int64_t{object.points}).add("position_m", seen.position_m.values);
  line.add("orientation_xyzw", quaternionOf(seen.R_vehicle_body));
  addOrNull(line, "pose_covariance", seen.pose_covariance);
  line.add("velocity_mps", seen.velocity_mps.values).add("velocity_covariance", seen.velocity_covariance.values);
  line.add("yaw_rate_radps", object.yaw_rate_radps).add("yaw_rate_sigma_radps", object.yaw_rate_sigma_radps);
  addAcceleration(line, object.acceleration);
  addBox(line, seen.box);
  publish_(line.text());
}

void ObjectPublisher::publish(const HealthMonitor& health, const motorcade::Tracker::Counts& counts,
                              const std::string& reason) {
  const Level level = health.level();
  const HealthMonitor::Latency latency = health.latency();
  JsonLine line("health");
  line.add("level", vehicle_stack::nameOf(level)).add("reason", reason);
  line.add("objects_valid", level == Level::kHealthy || level == Level::kDegraded);
  line.add("stale_objects", takeStale(level));
  line.add("latency_p50_ms", latency.p50_ms).add("latency_p99_ms", latency.p99_ms);
  line.add("latency_max_ms", latency.max_ms).add("pushed", counts.pushed).add("rejected", counts.rejected);
  line.add("dropped", counts.dropped).add("results", counts.results).add("untaken", counts.untaken);
  publish_(line.text());
}

/// The objects that whoever reads must forget now, each told once.
std::vector<std::int64_t> ObjectPublisher::takeStale(Level level) {
  const std::scoped_lock lock(mutex_);
  if (level != Level::kBlind) return {};
  return std::exchange(published_, {});
}

}  // namespace vehicle_stack
