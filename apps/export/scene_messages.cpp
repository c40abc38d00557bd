#include "apps/export/scene_messages.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <foxglove/SceneUpdate.pb.h>

#include "apps/draw/palette.hpp"
#include "apps/export/foxglove_fields.hpp"
#include "core/object_place.hpp"
#include "io/results/object_row.hpp"

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

}  // namespace motorcade
