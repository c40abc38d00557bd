#include "apps/view/shown_frame.hpp"

namespace motorcade {

std::optional<RoadPlane> roadUnder(const FrameEstimate& estimate) {
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  const Eigen::Vector3d camera = estimate.T_world_cam.translation();
  double below_m = 0;
  int objects = 0;
  for (const ObjectEstimate& object : estimate.objects)
    if (object.cuboid) up += object.T_world_body.rotation().col(2);
  if (up.norm() < 1e-6) return std::nullopt;
  up.normalize();
  for (const ObjectEstimate& object : estimate.objects) {
    if (!object.cuboid) continue;
    const Eigen::Vector3d bottom =
        object.cuboid->center_body - 0.5 * object.cuboid->size_m.z() * Eigen::Vector3d::UnitZ();
    below_m += up.dot(camera - object.T_world_body * bottom);
    ++objects;
  }
  return RoadPlane{.point_world = camera - below_m / objects * up, .up_world = up};
}

}  // namespace motorcade
