#include "apps/export/frame_messages.hpp"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>
#include <foxglove/CameraCalibration.pb.h>
#include <foxglove/CompressedImage.pb.h>
#include <foxglove/FrameTransforms.pb.h>
#include <foxglove/PointCloud.pb.h>
#include <foxglove/PoseInFrame.pb.h>
#include <foxglove/PosesInFrame.pb.h>
#include <foxglove/SceneUpdate.pb.h>
#include <motorcade/FrameDiagnostics.pb.h>

#include "apps/draw/palette.hpp"
#include "apps/export/foxglove_fields.hpp"
#include "core/object_place.hpp"
#include "io/results/object_row.hpp"
#include "io/results/run_folder.hpp"

namespace motorcade {
namespace {

constexpr double kWay_s = 3;
constexpr double kLineWidth_px = 2, kText_px = 14;
constexpr double kTextAbove_m = 0.6;  // the cuboid
constexpr double kOpaque = 1, kGlass = 0.5, kFaint = 0.2;

std::string entityId(TrackId track) { return "object_" + std::to_string(track.value); }

Eigen::Vector3d centerOf(const ObjectEstimate& object) { return placeOf(object).center_world; }

void addFact(foxglove::SceneEntity& entity, const char* key, std::string value) {
  foxglove::KeyValuePair* const fact = entity.add_metadata();
  fact->set_key(key);
  fact->set_value(std::move(value));
}

void addFacts(foxglove::SceneEntity& entity, const ObjectEstimate& object) {
  addFact(entity, "track_id", std::to_string(object.track.value));
  addFact(entity, "state", std::string(stateName(object.state)));
  addFact(entity, "kind", std::string(kindName(object.cuboid ? object.cuboid->kind : ObjectKind::kUnknown)));
  addFact(entity, "existence_probability", fmt::format("{:.3f}", object.existence_probability));
  addFact(entity, "speed_mps", fmt::format("{:.4f}", object.velocity_world_mps.norm()));
  addFact(entity, "speed_sigma_mps", fmt::format("{:.4f}", object.speed_sigma_mps));
  addFact(entity, "yaw_rate_radps", fmt::format("{:.6f}", object.yaw_rate_radps));
  if (object.acceleration) {
    addFact(entity, "acceleration_mps2", fmt::format("{:.4f}", object.acceleration->along_mps2));
    addFact(entity, "acceleration_sigma_mps2", fmt::format("{:.4f}", object.acceleration->along_sigma_mps2));
  }
  addFact(entity, "points", std::to_string(object.points));
}

void addCube(foxglove::SceneEntity& entity, const ObjectEstimate& object) {
  if (!object.cuboid) return;
  foxglove::CubePrimitive* const cube = entity.add_cubes();
  set(cube->mutable_pose(), object.T_world_body * SE3(Eigen::Matrix3d::Identity(), object.cuboid->center_body));
  set(cube->mutable_size(), object.cuboid->size_m);
  set(cube->mutable_color(), trackColor(object.track), object.state == ObjectState::kPredicted ? kFaint : kGlass);
}

void addText(foxglove::SceneEntity& entity, const ObjectEstimate& object) {
  const double height_m = object.cuboid ? object.cuboid->size_m.z() : 0;
  const Eigen::Vector3d up_world = object.T_world_body.rotation().col(2);  // the body's z axis
  foxglove::TextPrimitive* const text = entity.add_texts();
  set(text->mutable_pose(), {Eigen::Matrix3d::Identity(), centerOf(object) + (height_m / 2 + kTextAbove_m) * up_world});
  text->set_billboard(true);
  text->set_font_size(kText_px);
  text->set_scale_invariant(true);
  set(text->mutable_color(), trackColor(object.track), kOpaque);
  text->set_text(fmt::format("{}: {:.1f} +/- {:.1f} m/s", object.track.value, object.velocity_world_mps.norm(),
                             object.speed_sigma_mps));
}

/// Adds a line through elements that have a `p_world` each.
void addWay(foxglove::SceneEntity& entity, TrackId track, const auto& way) {
  foxglove::LinePrimitive* const line = entity.add_lines();
  line->set_type(foxglove::LinePrimitive::LINE_STRIP);
  set(line->mutable_pose(), SE3());
  line->set_thickness(kLineWidth_px);
  line->set_scale_invariant(true);
  set(line->mutable_color(), trackColor(track), kOpaque);
  for (const auto& passed : way) {
    foxglove::Point3* const point = line->add_points();
    point->set_x(passed.p_world.x());
    point->set_y(passed.p_world.y());
    point->set_z(passed.p_world.z());
  }
}

/// Layout of a point in a point cloud; points follow each other without gaps.
struct PackedPoint {
  float x_m, y_m, z_m;
  std::int32_t track;
  std::uint8_t red, green, blue, alpha;
};
constexpr std::uint32_t kPoint_bytes = 20;
static_assert(sizeof(PackedPoint) == kPoint_bytes && std::endian::native == std::endian::little);
constexpr Color kAtRest{150, 160, 170};

void addField(foxglove::PointCloud& cloud, const char* name, std::size_t offset,
              foxglove::PackedElementField::NumericType type) {
  foxglove::PackedElementField* const field = cloud.add_fields();
  field->set_name(name);
  field->set_offset(static_cast<std::uint32_t>(offset));
  field->set_type(type);
}

PackedPoint packed(const ExportedFrame::Point& point) {
  const Color color = point.track.valid() ? trackColor(point.track) : kAtRest;
  const Eigen::Vector3f p_cam = point.p_cam.cast<float>();
  return {.x_m = p_cam.x(),
          .y_m = p_cam.y(),
          .z_m = p_cam.z(),
          .track = static_cast<std::int32_t>(point.track.value),
          .red = static_cast<std::uint8_t>(color.red),
          .green = static_cast<std::uint8_t>(color.green),
          .blue = static_cast<std::uint8_t>(color.blue),
          .alpha = 255};
}

/// Adds the position and the rotation of the child in its parent.
void addTransform(foxglove::FrameTransforms& transforms, Timestamp stamp, const char* parent, const std::string& child,
                  const SE3& T_parent_child) {
  foxglove::FrameTransform* const transform = transforms.add_transforms();
  set(transform->mutable_timestamp(), stamp);
  transform->set_parent_frame_id(parent);
  transform->set_child_frame_id(child);
  set(transform->mutable_translation(), T_parent_child.translation());
  set(transform->mutable_rotation(), T_parent_child.rotation());
}

int pointsOnObjects(const ExportedFrame& frame) {
  return static_cast<int>(std::ranges::count_if(frame.points, [](const auto& point) { return point.track.valid(); }));
}

}  // namespace

/// Only of the objects in this frame.
void SceneMessages::remember(const FrameEstimate& estimate) {
  std::map<TrackId, std::deque<Passed>> ways;
  for (const ObjectEstimate& object : estimate.objects) {
    std::deque<Passed> way = std::move(ways_[object.track]);
    way.push_back({estimate.head.stamp, centerOf(object)});
    while (secondsBetween(way.front().stamp, estimate.head.stamp) > kWay_s) way.pop_front();
    ways[object.track] = std::move(way);
  }
  ways_ = std::move(ways);
}

std::string SceneMessages::operator()(const FrameEstimate& estimate) {
  foxglove::SceneUpdate update;
  for (const auto& [track, way] : ways_) {
    if (std::ranges::find(estimate.objects, track, &ObjectEstimate::track) != estimate.objects.end()) continue;
    foxglove::SceneEntityDeletion* const deletion = update.add_deletions();
    set(deletion->mutable_timestamp(), estimate.head.stamp);
    deletion->set_type(foxglove::SceneEntityDeletion::MATCHING_ID);
    deletion->set_id(entityId(track));
  }
  remember(estimate);
  for (const ObjectEstimate& object : estimate.objects) {
    foxglove::SceneEntity& entity = *update.add_entities();
    set(entity.mutable_timestamp(), estimate.head.stamp);
    entity.set_frame_id(kWorldFrame);
    entity.set_id(entityId(object.track));
    addFacts(entity, object);
    addCube(entity, object);
    addText(entity, object);
    addWay(entity, object.track, ways_[object.track]);
  }
  return update.SerializeAsString();
}

std::string imageMessage(const ExportedFrame& frame) {
  foxglove::CompressedImage image;
  set(image.mutable_timestamp(), frame.estimate.head.stamp);
  image.set_frame_id(kCameraFrame);
  image.set_format("jpeg");
  image.set_data(frame.jpeg);
  return image.SerializeAsString();
}

std::string calibrationMessage(const StereoCamera& camera, Timestamp stamp) {
  foxglove::CameraCalibration calibration;
  set(calibration.mutable_timestamp(), stamp);
  calibration.set_frame_id(kCameraFrame);
  calibration.set_width(static_cast<std::uint32_t>(camera.width_px));
  calibration.set_height(static_cast<std::uint32_t>(camera.height_px));
  for (const double k : {camera.fx_px, 0.0, camera.cx_px, 0.0, camera.fy_px, camera.cy_px, 0.0, 0.0, 1.0})
    calibration.add_k(k);
  for (int i = 0; i < 9; ++i) calibration.add_r(i % 4 == 0 ? 1 : 0);
  for (const double p :
       {camera.fx_px, 0.0, camera.cx_px, 0.0, 0.0, camera.fy_px, camera.cy_px, 0.0, 0.0, 0.0, 1.0, 0.0})
    calibration.add_p(p);
  return calibration.SerializeAsString();
}

std::string transformsMessage(const FrameEstimate& estimate) {
  foxglove::FrameTransforms transforms;
  addTransform(transforms, estimate.head.stamp, kMapFrame, kWorldFrame, mapFromWorld());
  addTransform(transforms, estimate.head.stamp, kWorldFrame, kCameraFrame, estimate.T_world_cam);
  for (const ObjectEstimate& object : estimate.objects)
    addTransform(transforms, estimate.head.stamp, kWorldFrame, "object_" + std::to_string(object.track.value),
                 object.T_world_body);
  return transforms.SerializeAsString();
}

std::string poseMessage(const FrameEstimate& estimate) {
  foxglove::PoseInFrame pose;
  set(pose.mutable_timestamp(), estimate.head.stamp);
  pose.set_frame_id(kWorldFrame);
  set(pose.mutable_pose(), estimate.T_world_cam);
  return pose.SerializeAsString();
}

std::string pathMessage(Timestamp stamp, const std::vector<SE3>& T_world_cam) {
  foxglove::PosesInFrame path;
  set(path.mutable_timestamp(), stamp);
  path.set_frame_id(kWorldFrame);
  for (const SE3& pose : T_world_cam) set(path.add_poses(), pose);
  return path.SerializeAsString();
}

std::string pointsMessage(const ExportedFrame& frame) {
  using foxglove::PackedElementField;
  foxglove::PointCloud cloud;
  set(cloud.mutable_timestamp(), frame.estimate.head.stamp);
  cloud.set_frame_id(kCameraFrame);
  set(cloud.mutable_pose(), SE3());
  cloud.set_point_stride(kPoint_bytes);
  addField(cloud, "x", offsetof(PackedPoint, x_m), PackedElementField::FLOAT32);
  addField(cloud, "y", offsetof(PackedPoint, y_m), PackedElementField::FLOAT32);
  addField(cloud, "z", offsetof(PackedPoint, z_m), PackedElementField::FLOAT32);
  addField(cloud, "track_id", offsetof(PackedPoint, track), PackedElementField::INT32);
  addField(cloud, "red", offsetof(PackedPoint, red), PackedElementField::UINT8);
  addField(cloud, "green", offsetof(PackedPoint, green), PackedElementField::UINT8);
  addField(cloud, "blue", offsetof(PackedPoint, blue), PackedElementField::UINT8);
  addField(cloud, "alpha", offsetof(PackedPoint, alpha), PackedElementField::UINT8);
  std::string data(frame.points.size() * kPoint_bytes, '\0');
  for (std::size_t i = 0; i < frame.points.size(); ++i) {
    const PackedPoint point = packed(frame.points[i]);
    std::memcpy(&data[i * kPoint_bytes], &point, kPoint_bytes);
  }
  cloud.set_data(std::move(data));
  return cloud.SerializeAsString();
}

std::string diagnosticsMessage(const ExportedFrame& frame) {
  FrameDiagnostics diagnostics;
  set(diagnostics.mutable_timestamp(), frame.estimate.head.stamp);
  diagnostics.set_frame(frame.estimate.head.frame.value);
  diagnostics.set_status(std::string(statusName(frame.estimate.head.status)));
  diagnostics.set_cause(std::string(causeName(frame.estimate.head.cause)));
  diagnostics.set_segment(frame.estimate.head.segment);
  diagnostics.set_latency_ms(frame.latency_ms);
  diagnostics.set_decode_ms(frame.decode_ms);
  for (std::size_t i = 0; frame.stages && i < kStageCount; ++i) {
    StageTime* const stage = diagnostics.add_stages();
    stage->set_stage(std::string(kStageKeys[i]));
    stage->set_work_ms((*frame.stages)[i].work_ms);
    stage->set_cpu_ms((*frame.stages)[i].cpu_ms);
  }
  diagnostics.set_objects(static_cast<std::int32_t>(frame.estimate.objects.size()));
  diagnostics.set_points_on_objects(pointsOnObjects(frame));
  diagnostics.set_points_at_rest(frame.points_at_rest);
  diagnostics.set_points_undecided(frame.points_undecided);
  return diagnostics.SerializeAsString();
}

}  // namespace motorcade
