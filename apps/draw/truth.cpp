#include "apps/draw/truth.hpp"

#include <map>

namespace motorcade {

std::set<std::int64_t> trueMovers(const RecordedDrive& drive) {
  constexpr double kMoved_m = 3;  // labels of a parked car wander by up to a meter
  std::map<std::int64_t, Eigen::Vector3d> first_world;
  std::set<std::int64_t> movers;
  for (const auto& [frame, objects] : drive.true_objects) {
    for (const ObjectTruth& object : objects) {
      const Eigen::Vector3d& p_world = object.T_world_object.translation();
      const Eigen::Vector3d& first = first_world.try_emplace(object.id, p_world).first->second;
      if ((p_world - first).norm() > kMoved_m) movers.insert(object.id);
    }
  }
  return movers;
}

}  // namespace motorcade
