#pragma once

#include <functional>
#include <numbers>

#include "apps/evaluate/comparison/followed_objects.hpp"

namespace motorcade::test {

/// A label that turns as it goes ahead of a turning camera, about 20 m away; the body's origin, seen from the camera,
/// lies where `origin_label` says on the label, and its axes are turned against the label's by a constant.
/// `drift` is the error of the estimated camera in the world.
inline FollowedLabel followedByHand(
    int first, int end, const std::function<Eigen::Vector3d(int)>& origin_label,
    const std::function<SE3(int)>& drift = [](int) { return SE3(); }) {
  FollowedLabel followed;
  followed.label = 7;
  followed.track = {3};
  const Eigen::Matrix3d label_body = expSO3({0.5 * std::numbers::pi, 0.1, 0});
  for (int i = first; i < end; ++i) {
    const SE3 T_world_cam(expSO3({0, 0.01 * i, 0}), {0.1 * i, 0, 1.0 * i});
    const SE3 T_cam_label(expSO3({0, 0.02 * i - 0.5 * std::numbers::pi, 0}), {2 - 0.1 * i, 1.6, 20 + 0.2 * i});
    const SE3 T_cam_body = T_cam_label * SE3(label_body, origin_label(i));
    followed.frames.push_back(
        {{i}, drift(i) * T_world_cam * T_cam_body, T_world_cam * T_cam_label, T_cam_body, T_cam_label});
  }
  return followed;
}

}  // namespace motorcade::test
