#include "apps/synth/models/models.hpp"
#include "core/se3.hpp"

namespace motorcade::synth {
namespace {

struct Extent {
  Vec3 lo{1e9F, 1e9F, 0}, hi{-1e9F, -1e9F, -1e9F};
  void include(const Vec3& p) {
    hi = max(hi, p);
    lo = min(lo, p);
  }
};

void includeLimbs(Extent& extent, const Model& model, const SE3& T_body_model, double driven_m) {
  for (const Limb& limb : model.limbs) {
    const SE3 T_body_limb = T_body_model * limb.T_parent_limb(driven_m);
    for (const auto& part : limb.model->parts)
      for (const Vec3& p : hullPoints(part, limb.model->cuts.data())) {
        const Eigen::Vector3d q = T_body_limb * Eigen::Vector3d(p.x, p.y, p.z);
        extent.include({static_cast<float>(q.x()), static_cast<float>(q.y()), static_cast<float>(q.z())});
      }
    includeLimbs(extent, *limb.model, T_body_limb, driven_m);
  }
}

}  // namespace

void fitBox(Model& model, double cycle_m) {
  constexpr int kPoses = 32;  // of a cycle
  Extent extent;
  for (const auto& part : model.parts)
    for (const Vec3& p : hullPoints(part, model.cuts.data())) extent.include(p);
  for (int i = 0; i < (model.limbs.empty() ? 0 : kPoses); ++i) includeLimbs(extent, model, {}, cycle_m * i / kPoses);
  model.length_m = 2 * std::max(extent.hi.x, -extent.lo.x);
  model.width_m = 2 * std::max(extent.hi.y, -extent.lo.y);
  model.height_m = extent.hi.z;
}

}  // namespace motorcade::synth
