#include "apps/evaluate/comparison/recovered_finals.hpp"

#include <algorithm>
#include <iterator>
#include <vector>

namespace motorcade {

std::size_t recoverFinals(RunFolder& run) {
  std::vector<SE3>& camera = run.final.camera;
  const std::size_t known = camera.size(), all = run.online.camera.size();
  if (known >= all) return 0;
  const SE3 T_final_online = known > 0 ? camera.back() * run.online.camera[known - 1].inverse() : SE3();
  for (std::size_t i = known; i < all; ++i) camera.push_back((T_final_online * run.online.camera[i]).normalized());

  const auto at = [&run](std::size_t frames) { return FrameId{run.first_frame + static_cast<std::int64_t>(frames)}; };
  const auto isUnknown = [&](const auto& row) { return row.frame >= at(known); };
  std::erase_if(run.final.objects, isUnknown);
  for (RunFolder::ObjectRow row : run.online.objects) {
    if (row.frame < at(known) || row.frame >= at(all)) continue;
    row.object.T_world_body = (T_final_online * row.object.T_world_body).normalized();
    row.object.velocity_world_mps = T_final_online.rotation() * row.object.velocity_world_mps;
    run.final.objects.push_back(row);
  }
  for (auto rows : {&RunFolder::Trajectories::covariances, &RunFolder::Trajectories::pose_covariances}) {
    std::erase_if(run.final.*rows, isUnknown);
    std::ranges::copy_if(run.online.*rows, std::back_inserter(run.final.*rows), isUnknown);
  }
  return all - known;
}

}  // namespace motorcade
