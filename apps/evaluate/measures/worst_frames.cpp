#include "apps/evaluate/measures/worst_frames.hpp"

#include <algorithm>
#include <functional>

#include "apps/evaluate/comparison/object_measures.hpp"
#include "apps/evaluate/comparison/trajectory_error.hpp"

namespace motorcade {
namespace {

/// Keeps the `most` largest errors. The earlier frame comes first when two are equal.
template <class Error>
void keepLargest(std::vector<Error>& errors, std::size_t most, double Error::*size) {
  std::ranges::stable_sort(errors, std::greater(), size);
  if (errors.size() > most) errors.erase(errors.begin() + static_cast<std::ptrdiff_t>(most), errors.end());
}

}  // namespace

WorstFrames worstFrames(const std::vector<ComparedFrame>& frames, std::size_t most) {
  WorstFrames worst;
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const ComparedFrame &before = frames[i - 1], &now = frames[i];
    const SE3 error = stepError(before.T_world_cam, now.T_world_cam, before.T_world_cam_true, now.T_world_cam_true);
    worst.camera.push_back({now.frame, error.translation().norm(), angleOf_deg(error.rotation())});
  }
  for (const ObjectStepError& step : objectStepErrors(askedPairs(frames)))
    worst.objects.push_back({step.frame, step.label, step.track, step.error.translation().norm()});
  keepLargest(worst.camera, most, &CameraFrameError::rpe_t_m);
  keepLargest(worst.objects, most, &ObjectFrameError::me_t_m);
  return worst;
}

}  // namespace motorcade
