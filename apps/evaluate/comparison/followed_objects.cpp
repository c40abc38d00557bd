#include "apps/evaluate/comparison/followed_objects.hpp"

#include <cmath>
#include <map>
#include <utility>

#include "apps/evaluate/comparison/object_measures.hpp"

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

namespace {

struct StepErrors {
  std::vector<double> m, deg;
};

void keepLarger(LargestStep& largest, double error, const ObjectStepError& step) {
  if (largest.label < 0 || error > largest.error) largest = {error, step.frame, step.label, step.track};
}

}  // namespace

FollowedMotion followedMotion(const std::vector<ComparedFrame>& frames) {
  const auto pairs = movingPairs(frames);
  std::map<std::int64_t, std::string> types;
  for (const AskedPair& pair : pairs) types[pair.object->truth.id] = pair.object->truth.type;
  std::map<std::int64_t, StepErrors> by_label;
  StepErrors all;
  FollowedMotion motion;
  for (const ObjectStepError& step : objectStepErrors(pairs)) {
    const double error_m = step.error.translation().norm(), error_deg = angleOf_deg(step.error.rotation());
    for (StepErrors* const errors : {&by_label[step.label], &all}) {
      errors->m.push_back(error_m);
      errors->deg.push_back(error_deg);
    }
    keepLarger(motion.largest_m, error_m, step);
    keepLarger(motion.largest_deg, error_deg, step);
  }
  for (auto& [label, errors] : by_label) {
    motion.objects.push_back(
        {label, types[label], statisticsOf(std::move(errors.m)), statisticsOf(std::move(errors.deg))});
    motion.rms_m += motion.objects.back().me_m.rmse / static_cast<double>(by_label.size());
    motion.rms_deg += motion.objects.back().me_deg.rmse / static_cast<double>(by_label.size());
  }
  motion.me_m = statisticsOf(std::move(all.m));
  motion.me_deg = statisticsOf(std::move(all.deg));
  return motion;
}

}  // namespace motorcade
