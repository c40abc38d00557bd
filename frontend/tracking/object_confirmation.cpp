#include "frontend/tracking/object_confirmation.hpp"

#include <algorithm>
#include <cmath>

#include "core/elementary.hpp"

namespace motorcade {
namespace {

constexpr double kSpeedSigmas = 9.0;  // of the speed above zero: a parked car with a bad track reaches a few
constexpr double kMinExtent_m = 0.3;  // span of the points: less is a blot, no vehicle
constexpr double kMinExtent_px = 20;  // in the image too: points whose patches overlap are one measurement

double diagonal_px(const Box& box) { return hypotenuse(box.right_px - box.left_px, box.bottom_px - box.top_px); }

}  // namespace

/// True when a few points that seem to lie behind a vehicle with many, and within its outline, are the vehicle's own
/// with wrong disparities. A vehicle that is cut off by the image's border, or at the left by that of the right image,
/// reaches beyond its points.
bool ObjectConfirmation::looksThrough(const ObjectObservation& few, const ObjectObservation& many) const {
  constexpr double kMargin = 0.25, kMaxMargin_px = 30;  // of the outline's width and height
  constexpr double kBorder_px = 80;
  constexpr int kMany = 3;  // times as many points
  const double z_m = many.T_cam_body.translation().z();
  if (many.frame != few.frame || many.points < kMany * few.points || z_m >= few.T_cam_body.translation().z())
    return false;
  const double du = std::min(kMaxMargin_px, kMargin * (many.box.right_px - many.box.left_px));
  const double dv = std::min(kMaxMargin_px, kMargin * (many.box.bottom_px - many.box.top_px));
  const bool cut_left = many.box.left_px < camera_.fx_px * camera_.baseline_m / z_m + kBorder_px;
  const bool cut_right = many.box.right_px > camera_.width_px - kBorder_px;
  return (cut_left || many.box.left_px - du < few.box.left_px) &&
         (cut_right || few.box.right_px < many.box.right_px + du) && many.box.top_px - dv < few.box.top_px &&
         few.box.bottom_px < many.box.bottom_px + dv;
}

/// True for a person who surely walks. People walk at 1.5 m/s, which is only a few standard deviations, so the way they
/// go, on the ground, must tell. Errors of matching are often high up, on facades and in trees.
bool ObjectConfirmation::walksSurely(const TrackedObject& object, double traveled_m, const GroundPlane& ground) const {
  constexpr double kWalkSigmas = 3, kTravel_m = 0.5, kChest_m = 1.5;
  constexpr int kObserved = 4;
  if (object.life.observations() < kObserved || traveled_m < kTravel_m) return false;
  const auto isLow = [&](const BodyPoint& p) { return ground.heightOf_m(object.T_cam_body * p.p_body) < kChest_m; };
  return movesSurely(object.kinematics, kWalkSigmas) && std::ranges::any_of(object.points, isLow);
}

bool ObjectConfirmation::operator()(const TrackedObject& object, const std::vector<ObjectObservation>& reported,
                                    const GroundPlane& ground) const {
  const ObjectObservation& newest = object.backlog.back();
  const auto hides = [&](const ObjectObservation& other) { return looksThrough(newest, other); };
  if (std::ranges::any_of(reported, hides) || diagonal_px(newest.box) < kMinExtent_px) return false;
  const double traveled_m = (object.kinematics.pose().translation() - object.spawned_at_world).norm();
  const bool surely = movesSurely(object.kinematics, kSpeedSigmas) || walksSurely(object, traveled_m, ground);
  return object.life.observations() >= params_.confirm_observations && traveled_m > params_.confirm_travel_m &&
         surely && object.extent(0).diagonal().norm() > kMinExtent_m;
}

bool ObjectConfirmation::movesSurely(const ObjectKinematics& kinematics, double sigmas) const {
  const double speed_mps = kinematics.speed_mps();
  return speed_mps > params_.confirm_speed_mps && speed_mps > sigmas * kinematics.speedSigma_mps();
}

std::vector<Parameter> parametersOf(ObjectConfirmation::Params& params) {
  return {numberParameter("confirm_observations", params.confirm_observations, {1, 10},
                          "fewer report an object earlier, more surely"),
          numberParameter("confirm_speed_mps", params.confirm_speed_mps, {0, 10}, "lower reports slower objects"),
          numberParameter("confirm_travel_m", params.confirm_travel_m, {0, 10},
                          "lower reports an object earlier, higher more surely")};
}

}  // namespace motorcade
