#include "io/results/object_row.hpp"

#include <algorithm>
#include <array>

#include "core/object_place.hpp"
#include "io/files/number_text.hpp"

namespace motorcade {
namespace {

constexpr std::array kStates = {ObjectState::kMoving, ObjectState::kStopped, ObjectState::kPredicted};
constexpr std::array kKinds = {ObjectKind::kUnknown, ObjectKind::kCar, ObjectKind::kLargeVehicle,
                               ObjectKind::kTwoWheeler, ObjectKind::kPedestrian};

ObjectBox readBox(FieldReader& fields) {
  ObjectBox box;
  for (auto* vector : {&box.center_body, &box.size_m, &box.center_sigma_m, &box.size_sigma_m})
    for (int axis = 0; axis < 3; ++axis) (*vector)[axis] = fields.number("cuboid");
  box.kind = fields.byName("kind", kKinds, kindName);
  box.kind_probability = fields.number("kind_probability");
  return box;
}

/// Four cells: all of them have a number, or none.
std::optional<ObjectAcceleration> readAcceleration(FieldReader& fields) {
  std::array<std::optional<double>, 4> cells;
  for (auto& cell : cells) cell = fields.numberOrNone("acceleration");
  const auto known = std::ranges::count_if(cells, [](const auto& cell) { return cell.has_value(); });
  if (known == 0) return std::nullopt;
  if (known < std::ssize(cells)) fields.fail("has only a part of an acceleration");
  return ObjectAcceleration{
      .along_mps2 = *cells[0], .along_sigma_mps2 = *cells[1], .yaw_radps2 = *cells[2], .yaw_sigma_radps2 = *cells[3]};
}

/// Reads columns that came later: rotation, place and age. Those that placeOf computes are passed over.
void readMotion(FieldReader& fields, ObjectEstimate& object) {
  for (int column = 0; column < 2; ++column) fields.number("heading");
  object.yaw_rate_radps = fields.number("yaw_rate_radps");
  object.yaw_rate_sigma_radps = fields.number("yaw_rate_sigma_radps");
  for (int column = 0; column < 6; ++column) fields.number("center");
  object.age_s = fields.number("age_s");
  if (!fields.atEnd()) object.existence_probability = fields.number("existence_probability");
  if (!fields.atEnd()) object.acceleration = readAcceleration(fields);
}

}  // namespace

std::string_view stateName(ObjectState state) {
  switch (state) {
    case ObjectState::kMoving:
      return "moving";
    case ObjectState::kStopped:
      return "stopped";
    case ObjectState::kPredicted:
      return "predicted";
  }
  return "moving";
}

std::string_view kindName(ObjectKind kind) {
  switch (kind) {
    case ObjectKind::kUnknown:
      return "unknown";
    case ObjectKind::kCar:
      return "car";
    case ObjectKind::kLargeVehicle:
      return "large_vehicle";
    case ObjectKind::kTwoWheeler:
      return "two_wheeler";
    case ObjectKind::kPedestrian:
      return "pedestrian";
  }
  return "unknown";
}

std::string objectLine(FrameId frame, const ObjectEstimate& object) {
  std::string line;
  line.reserve(560);
  appendInteger(line, frame.value);
  line += ',';
  appendInteger(line, object.track.value);
  line += ',';
  line += stateName(object.state);
  const auto add = [&](double value, int decimals) {
    line += ',';
    appendFixed(line, value, decimals);
  };
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) add(object.T_world_body.rotation()(row, column), 9);
    add(object.T_world_body.translation()[row], 6);
  }
  for (int axis = 0; axis < 3; ++axis) add(object.velocity_world_mps[axis], 4);
  add(object.speed_sigma_mps, 4);
  line += ',';
  appendInteger(line, object.points);
  for (const double edge_px : {object.box.left_px, object.box.top_px, object.box.right_px, object.box.bottom_px})
    add(edge_px, 2);
  const ObjectBox box = object.cuboid.value_or(ObjectBox{});
  for (const auto* vector : {&box.center_body, &box.size_m, &box.center_sigma_m, &box.size_sigma_m})
    for (int axis = 0; axis < 3; ++axis) add((*vector)[axis], 3);
  line += ',';
  line += kindName(box.kind);
  add(box.kind_probability, 3);
  const ObjectPlace place = placeOf(object);
  for (const double value_rad :
       {place.heading_rad, place.heading_sigma_rad, object.yaw_rate_radps, object.yaw_rate_sigma_radps})
    add(value_rad, 6);
  for (const Eigen::Vector3d& vector : {place.center_world, place.centerSigma_m()})
    for (const double value_m : vector) add(value_m, 3);
  add(object.age_s, 3);
  add(object.existence_probability, 3);
  if (const auto& acceleration = object.acceleration) {
    add(acceleration->along_mps2, 4);
    add(acceleration->along_sigma_mps2, 4);
    add(acceleration->yaw_radps2, 6);
    add(acceleration->yaw_sigma_radps2, 6);
  } else {
    line += ",,,,";
  }
  return line;
}

ObjectEstimate readObject(FieldReader& fields) {
  ObjectEstimate object;
  object.track.value = fields.integer("track_id");
  object.state = fields.byName("state", kStates, stateName);
  object.T_world_body = fields.pose("T_world_body");
  for (int axis = 0; axis < 3; ++axis) object.velocity_world_mps[axis] = fields.number("velocity");
  object.speed_sigma_mps = fields.number("speed_sigma_mps");
  object.points = static_cast<int>(fields.integer("points"));
  for (double* edge_px : {&object.box.left_px, &object.box.top_px, &object.box.right_px, &object.box.bottom_px})
    *edge_px = fields.number("box");
  if (fields.atEnd()) return object;
  const ObjectBox box = readBox(fields);
  if (box.size_m.x() > 0) object.cuboid = box;
  if (!fields.atEnd()) readMotion(fields, object);
  return object;
}

}  // namespace motorcade
