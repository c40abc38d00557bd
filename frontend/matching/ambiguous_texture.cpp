#include "frontend/matching/ambiguous_texture.hpp"

#include "frontend/image/patch_alignment.hpp"

namespace motorcade {

bool isFoundAtRestToo(const Image& now, const Eigen::Vector2d& now_px, const Image& before,
                      const Eigen::Vector2d& at_rest_px, const Eigen::Vector2d& followed_from_px, double scale,
                      const RepeatedTextureParams& params) {
  if ((at_rest_px - followed_from_px).norm() < params.min_separation_px) return false;
  const Eigen::Vector2f from = now_px.cast<float>();
  const auto patch =
      makeTemplate(now, from.x(), from.y(), kPatchWindow_px, PatchDeformation::kScale, static_cast<float>(scale));
  if (!patch) return false;
  PatchParams alignment;
  alignment.min_ncc = params.min_ncc;
  alignment.max_shift_px = params.max_prediction_px;
  const auto found = alignPatch(*patch, before, at_rest_px.cast<float>(), alignment);
  return found && (Eigen::Vector2d(found->u_px, found->v_px) - followed_from_px).norm() > params.min_separation_px;
}

}  // namespace motorcade
