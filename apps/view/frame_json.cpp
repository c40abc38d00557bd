#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/draw/palette.hpp"
#include "apps/latency/latency_report.hpp"
#include "apps/view/page_json.hpp"
#include "core/object_place.hpp"
#include "io/files/json_text.hpp"
#include "io/results/object_row.hpp"
#include "io/results/run_folder.hpp"

namespace motorcade {
namespace {

using Json = nlohmann::ordered_json;

/// Rounds away digits that nobody sees. JSON turns a value that is not finite into null.
double rounded(double value, double digits = 1e3) { return std::round(value * digits) / digits; }

Json toJson(const Eigen::Vector3d& vector) { return {rounded(vector.x()), rounded(vector.y()), rounded(vector.z())}; }

Json toJson(const SE3& T) {
  constexpr double kFiveDigits = 1e5;
  Json json = Json::array();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) json.push_back(rounded(T.rotation()(row, column), kFiveDigits));
    json.push_back(rounded(T.translation()[row]));
  }
  return json;
}

/// Adds the distance of the object's middle from the camera, and its standard deviation.
void addDistance(Json& json, const ObjectPlace& place, const Eigen::Vector3d& camera_world) {
  const Eigen::Vector3d way = place.center_world - camera_world;
  const double distance_m = way.norm();
  if (!(distance_m > 0)) return;
  const Eigen::Vector3d sight = way / distance_m;
  json["distance"] = rounded(distance_m);
  const double variance_m2 = sight.dot(place.center_covariance * sight);
  if (variance_m2 > 0) json["distance_sigma"] = rounded(std::sqrt(variance_m2));
}

void addAcceleration(Json& json, const ObjectAcceleration& acceleration) {
  json["acceleration"] = rounded(acceleration.along_mps2);
  json["acceleration_sigma"] = rounded(acceleration.along_sigma_mps2);
  json["yaw_acceleration"] = rounded(acceleration.yaw_radps2, 1e4);
  json["yaw_acceleration_sigma"] = rounded(acceleration.yaw_sigma_radps2, 1e4);
}

Json objectJson(const ObjectEstimate& object, const Eigen::Vector3d& camera_world) {
  const ObjectPlace place = placeOf(object);
  const Eigen::Matrix3d& C = place.center_covariance;
  Json json{{"id", object.track.value},
            {"color", trackColorText(object.track)},
            {"state", stateName(object.state)},
            {"T", toJson(object.T_world_body)},
            {"velocity", toJson(object.velocity_world_mps)},
            {"speed", rounded(object.velocity_world_mps.norm())},
            {"speed_sigma", rounded(object.speed_sigma_mps)},
            {"yaw_rate", rounded(object.yaw_rate_radps, 1e4)},
            {"yaw_rate_sigma", rounded(object.yaw_rate_sigma_radps, 1e4)},
            {"center", toJson(place.center_world)},
            {"points", object.points},
            {"age", rounded(object.age_s)},
            {"existence", rounded(object.existence_probability)},
            {"box",
             {rounded(object.box.left_px, 10), rounded(object.box.top_px, 10), rounded(object.box.right_px, 10),
              rounded(object.box.bottom_px, 10)}}};
  if (C.trace() > 0)
    json["center_covariance_xz"] = {rounded(C(0, 0), 1e5), rounded(C(0, 2), 1e5), rounded(C(2, 2), 1e5)};
  addDistance(json, place, camera_world);
  if (object.acceleration) addAcceleration(json, *object.acceleration);
  if (object.cuboid)
    json["cuboid"] = {{"center", toJson(object.cuboid->center_body)},
                      {"size", toJson(object.cuboid->size_m)},
                      {"kind", kindName(object.cuboid->kind)},
                      {"probability", rounded(object.cuboid->kind_probability)}};
  return json;
}

Json outlinesJson(const std::vector<ShownOutline>& outlines) {
  Json json = Json::array();
  for (const ShownOutline& outline : outlines) {
    Json polygons = Json::array();
    for (const Polygon& polygon : outline.polygons) {
      Json corners = Json::array();
      for (const auto& corner : polygon) {
        corners.push_back(corner.x());
        corners.push_back(corner.y());
      }
      polygons.push_back(std::move(corners));
    }
    json.push_back({{"id", outline.track.value}, {"polygons", std::move(polygons)}});
  }
  return json;
}

/// Track, left pixel and world position of each point.
Json pointsJson(const std::vector<ShownPoint>& points) {
  Json json = Json::array();
  for (const ShownPoint& point : points)
    json.push_back({point.track.value, rounded(point.uv_px.x(), 10), rounded(point.uv_px.y(), 10),
                    rounded(point.p_world.x(), 100), rounded(point.p_world.y(), 100), rounded(point.p_world.z(), 100)});
  return json;
}

Json timingJson(const ShownTiming& timing) {
  Json stages = Json::array();
  for (const double stage_ms : timing.stages_ms) stages.push_back(rounded(stage_ms));
  return {{"latency_ms", rounded(timing.latency_ms)},
          {"processing_ms", rounded(processing_ms(timing.stages_ms))},
          {"decode_ms", rounded(timing.decode_ms)},
          {"stages_ms", stages}};
}

Json trueObjectJson(const ShownTrueObject& object) {
  Json json{{"id", object.label},
            {"type", object.type},
            {"T", toJson(object.T_world_object)},
            // Its axes are the label's: x along the length, y down, from the middle of the bottom.
            {"cuboid",
             {{"center", toJson(Eigen::Vector3d(0, -0.5 * object.size_m.x(), 0))},
              {"size", toJson(Eigen::Vector3d(object.size_m.z(), object.size_m.x(), object.size_m.y()))}}},
            {"moving", object.moving}};
  if (object.track.valid()) {
    json["track"] = object.track.value;
    json["off_m"] = rounded(object.off_m);
  }
  if (object.motion_m) json["motion_m"] = rounded(*object.motion_m, 1e4);
  return json;
}

Json truthJson(const ShownTruth& truth, FrameDetail detail) {
  Json json{{"T", toJson(truth.T_world_cam)},
            {"position_m", rounded(truth.position_m, 1e4)},
            {"step_m", rounded(truth.step_m, 1e5)},
            {"step_deg", rounded(truth.step_deg, 1e4)}};
  if (detail == FrameDetail::kWithoutImageParts) return json;
  json["objects"] = Json::array();
  for (const ShownTrueObject& object : truth.objects) json["objects"].push_back(trueObjectJson(object));
  return json;
}

}  // namespace

std::string trackColorText(TrackId track) {
  const Color color = trackColor(track);
  return fmt::format("#{:02x}{:02x}{:02x}", color.red, color.green, color.blue);
}

std::string toJson(const ShownRun& run) {
  const StereoCamera& camera = run.camera;
  Json stages = Json::array();
  for (std::size_t stage = 0; stage < kStageCount; ++stage) stages.push_back(nameOf(static_cast<Stage>(stage)));
  return jsonText({{"name", run.name},
                   {"folder", run.folder},
                   {"recorded", run.recorded},
                   {"can_pause", run.can_pause},
                   {"first_frame", run.first_frame},
                   {"end_frame", run.end_frame},
                   {"rate_hz", rounded(run.rate_hz)},
                   {"paced", run.paced},
                   {"against", run.against},
                   {"stages", stages},
                   {"latency_bounds_ms", kLatencyBounds_ms},
                   {"camera",
                    {{"fx", camera.fx_px},
                     {"fy", camera.fy_px},
                     {"cx", camera.cx_px},
                     {"cy", camera.cy_px},
                     {"baseline", camera.baseline_m},
                     {"width", camera.width_px},
                     {"height", camera.height_px}}}});
}

std::string toJson(const ShownFrame& frame, Timestamp first_stamp, FrameDetail detail) {
  const FrameEstimate& estimate = frame.estimate;
  const bool degraded = estimate.head.status == FrameStatus::kGood && estimate.head.cause != FrameCause::kNone;
  Json json{{"frame", estimate.head.frame.value},
            {"time", rounded(secondsBetween(first_stamp, estimate.head.stamp))},
            {"status", degraded ? "degraded" : std::string(statusName(estimate.head.status))},
            {"cause", causeName(estimate.head.cause)},
            {"segment", estimate.head.segment},
            {"T", toJson(estimate.T_world_cam)},
            {"objects", Json::array()}};
  for (const ObjectEstimate& object : estimate.objects)
    json["objects"].push_back(objectJson(object, estimate.T_world_cam.translation()));
  if (frame.road) json["road"] = {{"point", toJson(frame.road->point_world)}, {"up", toJson(frame.road->up_world)}};
  if (frame.timing) json["timing"] = timingJson(*frame.timing);
  if (frame.truth) json["truth"] = truthJson(*frame.truth, detail);
  if (detail == FrameDetail::kAll) {
    json["outlines"] = outlinesJson(frame.outlines);
    json["points"] = pointsJson(frame.points);
  }
  return jsonText(json);
}

std::string eventJson(const RunSnapshot& run, const std::string& frame_json) {
  Json queues = Json::array();
  for (const QueueDepth& queue : run.queues)
    queues.push_back({{"name", queue.name}, {"waiting", queue.waiting}, {"bound", queue.bound}});
  const Json json{{"state", run.state},
                  {"received", run.received},
                  {"processed", run.processed},
                  {"dropped", run.dropped},
                  {"rejected", run.rejected},
                  {"lost", run.lost},
                  {"viewers", run.viewers},
                  {"latency_counts", run.latency.counts},
                  {"processing_counts", run.processing.counts},
                  {"queues", queues}};
  return R"({"run":)" + jsonText(json) + R"(,"frame":)" + (frame_json.empty() ? "null" : frame_json) + "}";
}

}  // namespace motorcade
