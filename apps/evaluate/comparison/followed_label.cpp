#include "apps/evaluate/comparison/followed_label.hpp"

#include <cmath>
#include <utility>

namespace motorcade {

double FollowedLabel::Frame::range_m() const {
  return std::hypot(T_cam_label.translation().x(), T_cam_label.translation().z());
}

std::vector<FollowedLabel> followedLabels(const std::vector<ComparedFrame>& frames) {
  std::map<std::pair<std::int64_t, TrackId>, FollowedLabel> followed;
  for (const AskedPair& pair : askedPairs(frames)) {
    const ObjectTruth& truth = pair.object->truth;
    const ObjectEstimate& object = pair.row->row.object;
    FollowedLabel& label = followed[{truth.id, object.track}];
    label.label = truth.id;
    label.track = object.track;
    label.frames.push_back({pair.frame->frame, object.T_world_body, truth.T_world_object,
                            pair.frame->T_world_cam.inverse() * object.T_world_body, truth.T_cam_object});
  }
  std::vector<FollowedLabel> labels;
  for (auto& [ids, label] : followed) labels.push_back(std::move(label));
  return labels;
}

}  // namespace motorcade
