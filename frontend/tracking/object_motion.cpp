#include "frontend/tracking/object_motion.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "core/decompositions.hpp"
#include "frontend/segmentation/geometric_constraints.hpp"
#include "frontend/tracking/small_body.hpp"

namespace motorcade {
namespace {

Box imageBox(const std::vector<const ScenePoint*>& points) {
  Box box{1e9, 1e9, -1e9, -1e9};
  for (const auto* p : points) {
    box.left_px = std::min(box.left_px, p->uvd_px.x());
    box.right_px = std::max(box.right_px, p->uvd_px.x());
    box.top_px = std::min(box.top_px, p->uvd_px.y());
    box.bottom_px = std::max(box.bottom_px, p->uvd_px.y());
  }
  return box;
}

template <class Observations>
MeasuredPoints measuredIn(const SceneMotion& scene, const Observations& observations) {
  MeasuredPoints measured{scene.features, {}};
  for (const auto& o : observations) measured.points.push_back(*o.now);
  return measured;
}

}  // namespace

PointMeasurement measurementOf(const ScenePoint& point, double disparity_offset_px) {
  const Eigen::Vector3d uvd_px = point.uvd_px - Eigen::Vector3d(0, 0, disparity_offset_px);
  return {.point = point.point, .uvd_px = uvd_px.cast<float>(), .sigma_px = point.sigma_px.cast<float>()};
}

const ScenePoint* findPoint(const SceneMotion& scene, PointId point) {
  const auto at = std::lower_bound(scene.points.begin(), scene.points.end(), point,
                                   [](const ScenePoint& p, PointId id) { return p.point < id; });
  return at != scene.points.end() && at->point == point ? &*at : nullptr;
}

std::vector<ObjectMotionEstimator::Observation> ObjectMotionEstimator::observations(const TrackedObject& object,
                                                                                    const SceneMotion& scene) const {
  std::vector<Observation> seen;
  for (std::size_t i = 0; i < object.points.size(); ++i)
    if (const auto* now = findPoint(scene, object.points[i].point)) seen.push_back({i, now});
  return seen;
}

PoseObservation ObjectMotionEstimator::observe(const BodyPoint& point, const ScenePoint& now) const {
  return {point.p_body, point.covariance, now.uvd_px, now.sigma_px};
}

PosePrior ObjectMotionEstimator::weakPrior(const SE3& T_cam_body) const {
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(params_.weak_position_m), params_.weak_tilt_rad, params_.weak_tilt_rad,
      params_.weak_yaw_rad;
  return {T_cam_body, sigma.cwiseAbs2().cwiseInverse().asDiagonal()};
}

std::vector<ScenePoint> ObjectMotionEstimator::search(const TrackedObject& object, const SceneMotion& scene,
                                                      const MeasuredPoints& known, const SE3& T_cam_body,
                                                      std::vector<Observation>& seen) const {
  if (!scene.features) return {};
  std::vector<ScenePoint> found =
      searchByProjection(object, known, *scene.features, T_cam_body, scene.disparity_offset_px, camera_);
  std::erase_if(found, [&](const ScenePoint& p) { return findPoint(scene, p.point) != nullptr; });
  for (const ScenePoint& p : found) seen.push_back({object.indexOf(p.point), &p});
  return found;
}

std::optional<ObjectMotionEstimator::Agreement> ObjectMotionEstimator::agree(const TrackedObject& object,
                                                                             std::vector<Observation> seen,
                                                                             const PosePrior& prior) const {
  Agreement a{.fit = {}, .seen = std::move(seen), .chi2 = {}, .inliers = {}};
  if (a.seen.empty()) return std::nullopt;
  std::vector<PoseObservation> observed;
  for (const auto& s : a.seen) observed.push_back(observe(object.points[s.body_point], *s.now));
  const PoseObservations observations(observed);
  const auto fit = fitPose(camera_, observations, prior.mean, params_.fit, &prior);
  if (!fit) return std::nullopt;
  a.fit = *fit;
  a.chi2 = poseChi2(camera_, observations, fit->T_cam_ref);
  for (std::size_t i = 0; i < a.seen.size(); ++i)
    if (a.chi2[i] < params_.inlier_chi2) a.inliers.push_back(a.seen[i]);
  a.enough = static_cast<int>(a.inliers.size()) >= params_.min_points;
  return a;
}

/// True for a followed point of a person whose own track proves that it moves, as the person does. Shadows move alike,
/// beside the body; feet rest on the ground.
bool ObjectMotionEstimator::provesWalk(const TrackedObject& object, const ScenePoint& point, const SceneMotion& scene,
                                       const SE3& T_world_cam) const {
  constexpr double kShadow_m = 0.3;  // height over the ground up to which a point may be of the shadow, or of a foot
  return object.born_slow && mayBeWalking(object, camera_) && point.flow && !point.ambiguous &&
         scene.ground.heightOf_m(point.flow->p_cam) > kShadow_m &&
         movesSurely(camera_, *point.flow, scene.camera_speed_mps) && object.carries(*point.flow, T_world_cam);
}

std::optional<ObjectObservation> ObjectMotionEstimator::follow(TrackedObject& object, const SceneMotion& scene,
                                                               const SE3& T_world_cam) const {
  const PosePrior prior{T_world_cam.inverse() * object.kinematics.pose(), inverse(object.kinematics.poseCovariance())};
  std::vector<Observation> seen = observations(object, scene);
  auto agreement = agree(object, seen, prior);
  std::vector<ScenePoint> searched;
  if (!agreement || !agreement->enough || mayBeWalking(object, camera_)) {
    searched = search(object, scene, object.measured, prior.mean, seen);
    agreement = agree(object, std::move(seen), prior);
  }
  if (!agreement) return std::nullopt;
  const auto proves = [&](const Observation& o) { return provesWalk(object, *o.now, scene, T_world_cam); };
  if (!agreement->enough && !std::ranges::any_of(agreement->inliers, proves)) {
    // One or two points leave the pose open, and with it which of them fits.
    const bool determined = static_cast<int>(agreement->seen.size()) >= params_.min_points;
    if (determined) dropMisfits(object, agreement->seen, agreement->chi2);
    return std::nullopt;
  }
  object.T_cam_body = agreement->fit.T_cam_ref;
  object.kinematics.acceptPose((T_world_cam * object.T_cam_body).normalized(), agreement->fit.covariance);
  ObjectObservation observation =
      measureEncounter(object, agreement->inliers, object.T_cam_body, scene.disparity_offset_px);
  object.measured = measuredIn(scene, agreement->inliers);
  refinePoints(object, agreement->inliers);
  dropMisfits(object, agreement->seen, agreement->chi2);
  if (mayBeWalking(object, camera_)) addPatches(scene, object.T_cam_body, object, object.measured);
  return observation;
}

std::optional<ObjectMotionEstimator::Found> ObjectMotionEstimator::lookBack(const TrackedObject& object,
                                                                            const SceneMotion& earlier,
                                                                            const MeasuredPoints& later,
                                                                            const PosePrior& prior) const {
  std::vector<Observation> seen = observations(object, earlier);
  const std::vector<ScenePoint> searched = search(object, earlier, later, prior.mean, seen);
  const auto agreement = agree(object, std::move(seen), prior);
  if (!agreement || !agreement->enough) return std::nullopt;
  Found found{.observation =
                  measureEncounter(object, agreement->inliers, agreement->fit.T_cam_ref, earlier.disparity_offset_px),
              .fit = agreement->fit,
              .points = measuredIn(earlier, agreement->inliers)};
  return found;
}

std::optional<ObjectObservation> ObjectMotionEstimator::visibleEvidence(const TrackedObject& object,
                                                                        const SceneMotion& scene,
                                                                        const PosePrior& predicted) const {
  const auto origin = camera_.project(predicted.mean.translation());
  if (!origin || !camera_.inLeftImage(origin->x(), origin->y())) return std::nullopt;
  const std::vector<const ScenePoint*> visible = pointsWithin(object, scene, predicted.mean);
  if (static_cast<int>(visible.size()) < params_.min_points) return std::nullopt;
  ObjectObservation observation;
  observation.points = static_cast<int>(visible.size());
  observation.box = imageBox(visible);
  observation.T_cam_body = predicted.mean;
  observation.encounter_covariance = inverse(weakPrior(predicted.mean).information);
  return observation;
}

/// Points of unknown motion that may lie within the object's outline.
std::vector<const ScenePoint*> ObjectMotionEstimator::pointsWithin(const TrackedObject& object,
                                                                   const SceneMotion& scene,
                                                                   const SE3& T_cam_body) const {
  Eigen::AlignedBox3d outline = object.core(SE3{});
  outline.min().array() -= params_.evidence_margin_m;
  outline.max().array() += params_.evidence_margin_m;
  const SE3 T_body_cam = T_cam_body.inverse();
  const auto mayLieWithin = [&](const ScenePoint& p) {
    const Eigen::Vector3d p_body = T_body_cam * camera_.triangulate(p.uvd_px);
    const Eigen::Vector3d beyond = p_body - p_body.cwiseMax(outline.min()).cwiseMin(outline.max());
    const Eigen::Matrix3d J = T_body_cam.rotation() * camera_.triangulationJacobian(p.uvd_px);
    const Eigen::Matrix3d C = J * p.sigma_px.cwiseAbs2().asDiagonal() * J.transpose();
    return beyond.dot(C.inverse() * beyond) < params_.inlier_chi2;
  };
  std::vector<const ScenePoint*> visible;
  for (const ScenePoint& p : scene.points)
    if (p.label != PointLabel::kStatic && p.label != PointLabel::kGround && !p.ambiguous && mayLieWithin(p))
      visible.push_back(&p);
  return visible;
}

MeasuredPoints ObjectMotionEstimator::measuredPoints(const TrackedObject& object, const SceneMotion& scene) const {
  return measuredIn(scene, observations(object, scene));
}

void ObjectMotionEstimator::addNearby(const SceneMotion& scene, const SE3& T_cam_body, TrackedObject& object,
                                      MeasuredPoints& measured) const {
  add(pointsWithin(object, scene, T_cam_body), T_cam_body, object, measured);
}

void ObjectMotionEstimator::addPatches(const SceneMotion& scene, const SE3& T_cam_body, TrackedObject& object,
                                       MeasuredPoints& measured) const {
  MeasuredPoints followed = measured;
  std::erase_if(followed.points, [](const ScenePoint& p) { return !isFollowed(p.point); });
  const auto trunk = mayBeWalking(object, camera_) ? trunkOf(object, T_cam_body, scene.ground, camera_) : std::nullopt;
  const double offset_px = scene.disparity_offset_px;
  const std::vector<ScenePoint> patches =
      trunk && scene.features ? samplePatches(*scene.features, trunk->box, trunk->disparity_px, offset_px)
                              : samplePatches(followed.points.empty() ? measured : followed, offset_px);
  measured = std::move(followed);
  std::erase_if(object.points, [](const BodyPoint& p) { return !isFollowed(p.point); });
  std::vector<const ScenePoint*> points;
  for (const ScenePoint& p : patches) points.push_back(&p);
  add(points, T_cam_body, object, measured);
}

void ObjectMotionEstimator::add(const std::vector<const ScenePoint*>& points, const SE3& T_cam_body,
                                TrackedObject& object, MeasuredPoints& measured) const {
  std::vector<BodyPoint> of_body;
  for (const ScenePoint* p : points) {
    if (object.find(p->point)) continue;
    of_body.push_back(toBody(*p, T_cam_body, camera_));
    measured.points.push_back(*p);
  }
  object.adopt(of_body);
}

void ObjectMotionEstimator::dropMisfits(TrackedObject& object, const std::vector<Observation>& seen,
                                        const std::vector<double>& chi2) const {
  std::vector<BodyPoint> kept;  // a point that was not seen is gone: its id never comes back
  for (std::size_t i = 0; i < seen.size(); ++i) {
    BodyPoint p = object.points[seen[i].body_point];
    p.misfits = chi2[i] < params_.inlier_chi2 ? 0 : p.misfits + 1;
    if (p.misfits < params_.max_misfits) kept.push_back(p);
  }
  std::ranges::sort(kept, {}, &BodyPoint::point);
  object.points = std::move(kept);
}

ObjectObservation ObjectMotionEstimator::measureEncounter(const TrackedObject& object,
                                                          const std::vector<Observation>& inliers,
                                                          const SE3& T_cam_body, double disparity_offset_px) const {
  std::vector<PoseObservation> observations;
  std::vector<const ScenePoint*> visible;
  for (const auto& s : inliers) {
    visible.push_back(s.now);
    observations.push_back(observe(object.points[s.body_point], *s.now));
  }
  const PosePrior weak = weakPrior(T_cam_body);
  const auto fit = fitPose(camera_, PoseObservations(observations), T_cam_body, params_.fit, &weak);
  ObjectObservation observation;
  observation.points = static_cast<int>(inliers.size());
  const bool walks = mayBeWalking(object, camera_);
  for (const ScenePoint* p : visible) {
    if (isFollowed(p->point))
      observation.measured.push_back(measurementOf(*p, disparity_offset_px));
    else if (walks)
      observation.patches.push_back(measurementOf(*p, disparity_offset_px));
  }
  std::ranges::sort(observation.measured, {}, &PointMeasurement::point);
  observation.box = imageBox(visible);
  observation.T_cam_body = fit ? fit->T_cam_ref : T_cam_body;
  observation.encounter_covariance = fit ? fit->covariance : inverse(weak.information);
  return observation;
}

/// Refines each point by one Kalman step, the pose taken as known.
void ObjectMotionEstimator::refinePoints(TrackedObject& object, const std::vector<Observation>& inliers) const {
  for (const auto& s : inliers) {
    BodyPoint& p = object.points[s.body_point];
    const Eigen::Vector3d p_cam = object.T_cam_body * p.p_body;
    const auto predicted = camera_.project(p_cam);
    if (!predicted) continue;
    const Eigen::Matrix3d J = camera_.projectionJacobian(p_cam) * object.T_cam_body.rotation();
    Eigen::Matrix3d S = J * p.covariance * J.transpose();
    S.diagonal() += s.now->sigma_px.cwiseAbs2();
    const Eigen::Matrix3d K = p.covariance * J.transpose() * S.inverse();
    p.p_body += K * (s.now->uvd_px - *predicted);
    const Eigen::Matrix3d C = p.covariance - K * J * p.covariance;
    p.covariance = 0.5 * (C + C.transpose());
  }
}

ObjectObservation ObjectMotionEstimator::firstObservation(const TrackedObject& object, const SceneMotion& scene) const {
  const auto seen = observations(object, scene);
  std::vector<PoseObservation> observations;
  std::vector<const ScenePoint*> visible;
  ObjectObservation observation;
  for (const auto& s : seen) {
    visible.push_back(s.now);
    observation.measured.push_back(measurementOf(*s.now, scene.disparity_offset_px));
    PoseObservation o = observe(object.points[s.body_point], *s.now);
    o.covariance_ref.setZero();  // the points were put into the body frame from these very observations
    observations.push_back(o);
  }
  observation.points = static_cast<int>(seen.size());
  observation.box = imageBox(visible);
  observation.T_cam_body = object.T_cam_body;
  const PosePrior weak = weakPrior(object.T_cam_body);
  const auto fit = fitPose(camera_, PoseObservations(observations), object.T_cam_body, params_.fit, &weak);
  observation.encounter_covariance = fit ? fit->covariance : inverse(weak.information);
  return observation;
}

}  // namespace motorcade
