#pragma once

#include "apps/evaluate/comparison/object_matching.hpp"

namespace motorcade::test {

/// A counted label of a car that moves ahead of us along the camera's z axis.
inline TrueObject labelByHand(std::int64_t id, double range_m, double aside_m = 0) {
  TrueObject object;
  object.counted = object.moving = object.ever_moves = true;
  object.truth.id = id;
  object.truth.type = "Car";
  object.truth.size_m = {1.5, 2, 4};
  Eigen::Matrix3d ahead;  // columns: x ahead along z, y down, z to the left
  ahead << 0, 0, -1, 0, 1, 0, 1, 0, 0;
  object.truth.T_cam_object = SE3(ahead, {aside_m, 1.6, range_m});
  object.truth.box = {100, 100, 200, 150};
  return object;
}

/// A row of a track whose cuboid of the label's size stands `aside_m` of the camera's axis and is turned by `turn_rad`.
inline MatchedRow rowByHand(int track, int object, double range_m, double aside_m = 0, double turn_rad = 0) {
  Eigen::Matrix3d upright;
  upright << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  MatchedRow row;
  row.object = object;
  row.row.object.track = {track};
  row.row.object.points = 20;
  row.row.object.box = {100, 100, 200, 150};
  row.row.object.T_world_body = SE3(upright * expSO3({0, 0, turn_rad}), {aside_m, 1.6, range_m});
  ObjectBox cuboid;
  cuboid.center_body = {0, 0, 0.75};
  cuboid.size_m = {4, 2, 1.5};
  cuboid.kind = ObjectKind::kCar;
  row.row.object.cuboid = cuboid;
  return row;
}

}  // namespace motorcade::test
