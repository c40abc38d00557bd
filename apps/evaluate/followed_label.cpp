#include "apps/evaluate/followed_label.hpp"

#include <cmath>
#include <utility>

namespace motorcade {

double FollowedLabel::Frame::range_m() const {
  return std::hypot(T_cam_label.translation().x(), T_cam_label.translation().z());
}

std::vector<FollowedLabel> followedLabels(const std::vector<ComparedFrame>& frames) {
  std::map<std::pair<std::int64_t, TrackId>, FollowedLabel> followed;
  for (const auto& frame : frames) {
    const SE3 T_cam_world = frame.T_world_cam.inverse();
    for (const auto& row : frame.rows) {
      if (row.object < 0 || !row.reported()) continue;
      const TrueObject& object = frame.objects[row.object];
      if (!object.asked()) continue;
      const SE3& T_world_body = row.row.object.T_world_body;
      FollowedLabel& label = followed[{object.truth.id, row.row.object.track}];
      label.label = object.truth.id;
      label.track = row.row.object.track;
      label.frames.push_back({frame.frame, T_world_body, object.truth.T_world_object, T_cam_world * T_world_body,
                              object.truth.T_cam_object});
    }
  }
  std::vector<FollowedLabel> labels;
  for (auto& [ids, label] : followed) labels.push_back(std::move(label));
  return labels;
}

}  // namespace motorcade
