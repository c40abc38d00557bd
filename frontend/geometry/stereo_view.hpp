#if defined(MOTORCADE_STEREO_VIEW) == defined(HWY_TARGET_TOGGLE)
#ifdef MOTORCADE_STEREO_VIEW
#undef MOTORCADE_STEREO_VIEW
#else
#define MOTORCADE_STEREO_VIEW
#endif

#include "core/stereo_camera.hpp"
#include "frontend/geometry/lane_algebra.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {

/// Stereo views of four points, each known in its own reference frame.
struct StereoViews {
  Doubles3 uvd_px;
  Doubles3x3 J;   // d (u, v, d) / d p_ref [px/m]
  Doubles ahead;  // 1, or 0 for a point closer than the camera sees, whose other values then have no meaning
};

/// Projects the points `p_ref_m`, which `R_cam_ref` and `t_cam_ref_m` take to the camera's frame.
HWY_INLINE StereoViews viewPoints(const StereoCamera& camera, const Doubles3x3& R_cam_ref, const Doubles3& t_cam_ref_m,
                                  const Doubles3& p_ref_m) {
  const Doubles3 p = R_cam_ref * p_ref_m + t_cam_ref_m;
  const auto is_ahead = p.z >= StereoCamera::kMinDepth_m;
  const Doubles one = 1.0, iz = one / choose(is_ahead, p.z, one);
  const Doubles x = camera.fx_px * iz, y = camera.fy_px * iz, d = camera.baseline_m * x;
  const Doubles u = x * p.x, v = y * p.y;
  return {{u + camera.cx_px, v + camera.cy_px, d},
          {x * R_cam_ref.x - (u * iz) * R_cam_ref.z, y * R_cam_ref.y - (v * iz) * R_cam_ref.z, (-d * iz) * R_cam_ref.z},
          choose(is_ahead, one, 0.0)};
}

/// Huber's loss of whitened squared residuals.
struct HuberLoss {
  Doubles weight;  // rho'(r) / r
  Doubles chi2;    // 2 rho(r): the squared residual itself in the quadratic part
};
HWY_INLINE HuberLoss huberLoss(const Doubles& chi2, double huber_sigmas) {
  const Doubles k = huber_sigmas, norm = squareRoots(chi2);
  const auto quadratic = norm <= k;
  return {choose(quadratic, 1.0, k / norm), choose(quadratic, chi2, 2 * k * norm - k * k)};
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
