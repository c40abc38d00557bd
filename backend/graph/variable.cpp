#include "backend/graph/variable.hpp"

namespace motorcade {

Value displaced(const Value& value, const SmallVector& step) {
  if (const auto* pose = std::get_if<SE3>(&value)) {
    const Eigen::Matrix3d turn = expSO3(step.tail<3>());
    return SE3(turn * pose->rotation(), pose->translation() + step.head<3>()).normalized();
  }
  if (const auto* pose = std::get_if<SE2>(&value))
    return SE2(pose->angle_rad() + step[2], pose->translation() + step.head<2>());
  return SmallVector(std::get<SmallVector>(value) + step);
}

SmallVector displacement(const Value& from, const Value& to) {
  SmallVector step(dimension(from));
  if (const auto* pose = std::get_if<SE3>(&from)) {
    const auto& moved = std::get<SE3>(to);
    step << moved.translation() - pose->translation(), logSO3(moved.rotation() * pose->rotation().transpose());
  } else if (const auto* planar = std::get_if<SE2>(&from)) {
    const auto& moved = std::get<SE2>(to);
    step << moved.translation() - planar->translation(),
        SE2(moved.angle_rad() - planar->angle_rad(), {0, 0}).angle_rad();
  } else {
    step = std::get<SmallVector>(to) - std::get<SmallVector>(from);
  }
  return step;
}

}  // namespace motorcade
