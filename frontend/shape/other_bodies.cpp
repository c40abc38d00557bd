#include "frontend/shape/other_bodies.hpp"

#include <algorithm>

namespace motorcade {
namespace {

/// Distance in cells, in the earlier image, between the viewed body and what goes along with another one.
double cellsApart(const ObjectView& view, const SE3& T_before_cam, const StereoCamera& camera) {
  const auto moved = camera.project(view.well_before->T_before_body.translation()),
             along = camera.project(T_before_cam * view.T_cam_body.translation());
  return moved && along ? (moved->head<2>() - along->head<2>()).norm() / (1 << view.level) : 0;
}

}  // namespace

OtherBodies::OtherBodies(const ObjectView& view, const StereoCamera& camera) {
  const auto add = [&](const ObjectView::Other& other) {
    ObjectView::Before before = *view.well_before;
    before.T_before_cam = *other.T_before_cam;
    bodies_.push_back({Eigen::AlignedBox3d(other.least, other.most), other.T_body_cam, before});
  };
  for (const ObjectView::Other& other : view.others)
    if (other.T_before_cam) add(other);
  for (const ObjectView::Other& lost : view.lost)
    if (lost.T_before_cam && cellsApart(view, *lost.T_before_cam, camera) > ObjectView::kWellApart) add(lost);
}

const ObjectView::Before* OtherBodies::around(const Eigen::Vector3d& p_cam, double margin_m) const {
  const auto holds = [&](const Body& body) {
    return body.cuboid.squaredExteriorDistance(body.T_body_cam * p_cam) <= margin_m * margin_m;
  };
  const auto body = std::ranges::find_if(bodies_, holds);
  return body != bodies_.end() ? &body->before : nullptr;
}

}  // namespace motorcade
