#include "backend/joint/frame_index.hpp"

#include <algorithm>

namespace motorcade {

FrameIndex::FrameIndex(std::span<LandmarkTrack* const> tracks, const PoseVariable& pose_variable)
    : first_(tracks.front()->views.front().frame) {
  FrameId last = first_;
  for (const LandmarkTrack* track : tracks) {
    first_ = std::min(first_, track->views.front().frame);
    last = std::max(last, track->views.back().frame);
  }
  place_.assign(last.value - first_.value + 1, kNone);
  for (const LandmarkTrack* track : tracks)
    for (const auto& view : track->views) place_[view.frame.value - first_.value] = kSeen;
  for (std::size_t i = 0; i < place_.size(); ++i) {
    const FrameId frame{first_.value + static_cast<std::int64_t>(i)};
    const VariableId variable = place_[i] == kNone ? VariableId{} : pose_variable(frame);
    place_[i] = variable.valid() ? static_cast<int>(frames_.size()) : kNone;
    if (!variable.valid()) continue;
    frames_.push_back(frame);
    variables_.push_back(variable);
  }
}

void FrameIndex::append(std::span<const LandmarkTrack::View> views, const NoiseLevel& noise,
                        std::vector<LandmarkView>& to) const {
  const Eigen::Vector3d level = noise.sigmas();
  for (const auto& view : views)
    if (const int place = place_[view.frame.value - first_.value]; place != kNone)
      to.push_back(
          {place, view.uvd_px.cast<double>(), level.cwiseProduct(view.sigma_px.cast<double>()).cwiseInverse()});
}

}  // namespace motorcade
