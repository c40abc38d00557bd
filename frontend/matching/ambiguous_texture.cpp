#include "frontend/matching/ambiguous_texture.hpp"

#include "frontend/image/patch_alignment.hpp"

namespace motorcade {
namespace {

constexpr double kMinNcc = 0.8;        // stricter than optical flow: the patch at rest speaks against a motion
constexpr double kMaxShift_px = 3;     // between the position at rest as predicted and as found: errors of ego-motion
constexpr double kMinDistance_px = 5;  // from the followed position: patches nearer than that overlap and look alike

}  // namespace

bool isAlsoFoundAtRest(const FollowedPatch& patch, const Eigen::Vector2d& at_rest_px, double scale) {
  if ((at_rest_px - patch.to_px).norm() < kMinDistance_px) return false;
  const Eigen::Vector2f from = patch.from_px.cast<float>();
  const auto looks = makeTemplate(patch.from, from.x(), from.y(), kPatchWindow_px, PatchDeformation::kScale,
                                  static_cast<float>(scale));
  if (!looks) return false;
  PatchParams alignment;
  alignment.min_ncc = kMinNcc;
  alignment.max_shift_px = kMaxShift_px;
  const auto found = alignPatch(*looks, patch.to, at_rest_px.cast<float>(), alignment);
  return found && (Eigen::Vector2d(found->u_px, found->v_px) - patch.to_px).norm() > kMinDistance_px;
}

}  // namespace motorcade
