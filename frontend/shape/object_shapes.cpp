#include "frontend/shape/object_shapes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/elementary.hpp"
#include "frontend/motion/shared_velocity_error.hpp"
#include "frontend/shape/face_measurement.hpp"
#include "frontend/shape/kind_belief.hpp"
#include "frontend/shape/motion_verdict.hpp"
#include "frontend/shape/object_sight.hpp"
#include "frontend/shape/outline_completion.hpp"
#include "frontend/shape/point_extent.hpp"
#include "frontend/tracking/small_body.hpp"

namespace motorcade {
namespace {

/// Share of what was known that is still believed a frame later: errors of successive outlines have much in common, and
/// the body frame may slide a little on the object.
constexpr double kFading = 0.97;
constexpr double kLookWeight = 0.15;                    // of one outline: for the same reason, seven count as one
constexpr std::int64_t kMemory_frames = 120;            // beyond which looks no longer count
constexpr double kLeastSize_m = 0.2, kMostSize_m = 25;  // of an object that is believed, along each axis
constexpr double kWhole = 0.85;                         // of a cuboid where both cameras see it: the look at it counts
constexpr int kFewLooks = 5;                            // so few are too few to do without one
constexpr double kTrunk_m = 0.4;                        // across a person
constexpr int kIterations = 2;  // of the faces, as what is seen of them depends on where they are

double fading(std::int64_t frames) { return power(kFading, static_cast<double>(std::abs(frames))); }

/// Fading of each look that counts, by its distance in frames.
const std::array<double, kMemory_frames + 1>& fadingByFrames() {
  static const auto fadings = [] {
    std::array<double, kMemory_frames + 1> by_frames;
    for (std::int64_t frames = 0; frames <= kMemory_frames; ++frames) by_frames[frames] = fading(frames);
    return by_frames;
  }();
  return fadings;
}

/// Evidence of the points by which an object is found: they mostly lie on the face of which the camera sees most.
FaceInformation nearFaceAtPoints(const ObjectView& view) {
  constexpr double kSigma_m = 0.6;
  FaceInformation near;
  if (!view.points) return near;
  const Eigen::Vector3d direction = view.T_cam_body.rotation().transpose() * view.T_cam_body.translation();
  constexpr double kLengthOverWidth = 2.5;  // of what is seen of a side and of an end, when seen at 45 degrees
  const int axis = std::abs(direction.x()) > kLengthOverWidth * std::abs(direction.y()) ? 0 : 1;
  if (direction[axis] > 0)
    near.add(Vector6d::Unit(2 * axis), view.points->min()[axis], kSigma_m);
  else
    near.add(Vector6d::Unit(2 * axis + 1), view.points->max()[axis], kSigma_m);
  return near;
}

/// The body's origin, which the cuboid of a walker holds where points are few: it is the middle of those that were
/// first followed. Otherwise the outline may take in a car that is parked behind, and then move over to it.
Eigen::AlignedBox3d atOrigin() {
  const Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  return {origin, origin};
}

/// Measurement of an object by the frame's earlier stages; null where it was not seen.
const ObjectObservation* observationOf(TrackId track, const FrameMeasurements& measurements) {
  const auto observed = std::ranges::find_if(measurements.objects, [&](const ObjectObservation& o) {
    return o.track == track && o.frame == measurements.head.frame;
  });
  return observed != measurements.objects.end() ? &*observed : nullptr;
}

void dropUnlikely(FrameEstimate& frame, double min_existence) {
  std::erase_if(frame.objects,
                [&](const ObjectEstimate& object) { return object.existence_probability < min_existence; });
}

/// Cuboids of objects that were known before this one, which may have their points on it. How each moved since `before`
/// tells.
std::vector<ObjectView::Other> cuboidsBeside(TrackId track, const std::vector<ObjectEstimate>& objects,
                                             const SE3& T_world_cam, const std::optional<ObjectView::Before>& before,
                                             const EarlierViews& earlier) {
  std::vector<ObjectView::Other> others;
  for (const ObjectEstimate& object : objects) {
    if (object.track == track || !object.cuboid) continue;
    const ObjectBox& box = *object.cuboid;
    const SE3 T_body_cam = object.T_world_body.inverse() * T_world_cam;
    others.push_back({T_body_cam, box.center_body - 0.5 * box.size_m, box.center_body + 0.5 * box.size_m});
    const SE3* place = before && object.track < track ? earlier.place(object.track, before->frame) : nullptr;
    if (place) others.back().T_before_cam = *place * T_body_cam;
  }
  return others;
}

ObjectMask maskOf(const Outline& outline, int level, TrackId track) {
  const PixelWindow bounds = outline.bounds();
  const int cell_px = 1 << level;
  ObjectMask mask{.track = track,
                  .left_px = (outline.window.u0 + bounds.u0) * cell_px,
                  .top_px = (outline.window.v0 + bounds.v0) * cell_px,
                  .cell_px = cell_px,
                  .width = bounds.width,
                  .height = bounds.height,
                  .inside = {}};
  for (int row = 0; row < bounds.height; ++row)
    for (int column = 0; column < bounds.width; ++column)
      mask.inside.push_back(outline.at(bounds.u0 + column, bounds.v0 + row) ? 1 : 0);
  return mask;
}

}  // namespace

EstimatesPtr ObjectShapes::operator()(const Inputs& inputs, const EstimatesPtr& estimates) {
  earlier_.move(inputs.scene->odometry.T_previous_now);
  camera_speed_mps_ = inputs.scene->camera_speed_mps;
  auto shaped = std::make_shared<Estimates>(*estimates);
  const SE3 T_cam_world = shaped->online.T_world_cam.inverse();
  for (ObjectEstimate& object : shaped->online.objects)
    if (const auto known = shapes_.find(object.track); known != shapes_.end())
      setBox(object, estimateBox(known->second.evidence, known->second.traits).box(),
             T_cam_world * object.T_world_body);
  predicted_ = lost_.predictedIn(shaped->online);
  for (const ObjectEstimate& lost : predicted_)
    earlier_.addPlace(lost.track, shaped->online.head.frame, T_cam_world * lost.T_world_body);
  for (ObjectEstimate& object : shaped->online.objects) lookAt(object, inputs, shaped->online, shaped->masks);
  dropLeft(shaped->online, camera_);
  lost_.remember(shaped->online);
  dropUnlikely(shaped->online, params_.min_existence);
  std::erase_if(shaped->masks, [&](const ObjectMask& mask) {
    return std::ranges::find(shaped->online.objects, mask.track, &ObjectEstimate::track) ==
           shaped->online.objects.end();
  });
  earlier_.add(*inputs.features);
  for (const FrameEstimate& settled : shaped->settled) addSettledSpeeds(settled);
  for (FrameEstimate& settled : shaped->settled) gatherShapes(settled);
  complete(shaped->finals);
  forgetGone(*shaped);
  return shaped;
}

void ObjectShapes::lookAt(ObjectEstimate& object, const Inputs& inputs, const FrameEstimate& frame,
                          std::vector<ObjectMask>& masks) {
  Shape& shape = shapes_[object.track];
  ObjectView view = viewOf(object, inputs, frame, shape);
  const bool predicted = object.state == ObjectState::kPredicted;
  auto seen = sight_(view, *inputs.features);
  if (!predicted) {
    shape.state = object.state;
    const auto* observed = observationOf(object.track, *inputs.measurements);
    const double sigma_mps = speedSigma_mps(object, frame.T_world_cam, camera_, camera_speed_mps_);
    shape.existence.addSpeed(object.velocity_world_mps.norm(), sigma_mps);
    if (observed) shape.existence.addFollowed(observed->measured.size() + (view.small ? observed->patches.size() : 0));
    const auto* disparities = seen ? &seen->disparities : nullptr;
    const bool rests = restsDespiteEstimate(object, sigma_mps);
    const auto verdict = rests ? MotionVerdict::kRested : motionVerdict(observed, disparities, view, camera_);
    shape.existence.addVerdict(frame.head.frame, verdict);
  }
  if (seen) {
    if (predicted && movesWithBody(seen->outline, seen->disparities, view, camera_))
      markSeen(object, shape.only_dense[frame.head.frame] = {shape.state, seen->outline.count()});
    const bool whole =
        shareInImages(view.box.box(), view.T_cam_body, camera_) > kWhole || std::ssize(shape.looks) < kFewLooks;
    if (const auto look = whole && !predicted ? measured(*seen, view, shape) : std::nullopt) {
      shape.evidence.add(*look, kLookWeight);
      shape.looks[frame.head.frame] = {*look, 0.5 * (view.box.least() + view.box.most()), view.T_cam_body};
    }
    if (object.state != ObjectState::kPredicted) {
      if (!seen->labelled) completeOutline(seen->outline, seen->disparities, view, camera_);
      masks.push_back(maskOf(seen->mask(), seen->disparities.level, object.track));
    }
  }
  object.existence_probability = shape.existence.probability();
  setBox(object, believedBox(shape.evidence, shape.traits), view.T_cam_body);
}

/// View of the object and belief in its cuboid. Its shape becomes that of this frame.
ObjectView ObjectShapes::viewOf(const ObjectEstimate& object, const Inputs& inputs, const FrameEstimate& frame,
                                Shape& shape) {
  const SceneMotion& scene = *inputs.scene;
  const SE3 T_cam_body = frame.T_world_cam.inverse() * object.T_world_body;
  const bool is_new = !shape.last.valid();
  if (is_new) {  // the tracker knows where it was before it was reported
    for (const ObjectObservation& o : inputs.measurements->objects)
      if (o.track == object.track && o.frame < frame.head.frame) earlier_.addPlace(o.track, o.frame, o.T_cam_body);
  } else {
    FaceInformation faded;
    faded.add(shape.evidence, fading(frame.head.frame.value - shape.last.value));
    shape.evidence = faded;
  }
  const auto* observed = observationOf(object.track, *inputs.measurements);
  if (is_new && observed && observed->born_slow && !observed->born_labelled) shape.existence.doubtSlowBirth();
  shape.last = frame.head.frame;
  shape.traits.speed_mps = object.velocity_world_mps.norm();
  ObjectView view{.T_cam_body = T_cam_body,
                  .box = estimateBox(shape.evidence, shape.traits),
                  .ground = scene.ground,
                  .disparity_offset_px = scene.disparity_offset_px,
                  .scene = scene.points};
  const auto extent_of = [&](const std::vector<PointMeasurement>& points) {
    return extentOf(points, camera_, T_cam_body.inverse(), scene.disparity_offset_px);
  };
  const PointExtent extent = observed ? extent_of(observed->measured) : PointExtent{};
  view.points = extent.box;
  if (extent.sure) shape.traits.least_size_m = shape.sure_sizes.add(extent.sure->sizes());
  if (is_new && observed && observed->born_slow && !view.points) view.points = extent_of(observed->patches).box;
  if (is_new && view.points) {
    if (!isCutOff(observed->box, T_cam_body, camera_)) shape.evidence = shape.first = nearFaceAtPoints(view);
    view.box = estimateBox(shape.evidence, shape.traits);
  }
  const ObjectKind small = smallKindOf(view, observed, shape);
  view.small = small != ObjectKind::kUnknown;
  if (view.small) view.box = estimateBox(shape.evidence, shape.traits, small);
  if (view.small && !view.points && shape.traits.speed_mps < kFastestWalk_mps) view.points = atOrigin();
  if (extent.sure && !view.small) view.box.reach(*extent.sure);
  view.level = sight_.levelOf(view, static_cast<int>(inputs.features->right.levels.size()));
  if (view.small) view.width = kTrunk_m * camera_.fx_px / T_cam_body.translation().z() / (1 << view.level);
  if (!is_new) view.before = earlier_.last(object.track, view, *inputs.features);
  view.well_before = earlier_.wellApart(object.track, view, *inputs.features);
  view.others = cuboidsBeside(object.track, frame.objects, frame.T_world_cam, view.well_before, earlier_);
  view.lost = cuboidsBeside(object.track, predicted_, frame.T_world_cam, view.well_before, earlier_);
  earlier_.addPlace(object.track, frame.head.frame, T_cam_body);
  return view;
}

/// Kind of a small object where it may well be one: pedestrian or two-wheeler. It is then looked for in a small volume.
/// An outline that outgrows it tells of a car soon enough; that of a person in a car's volume takes in what is beside.
ObjectKind ObjectShapes::smallKindOf(const ObjectView& view, const ObjectObservation* observed,
                                     const Shape& shape) const {
  constexpr double kFastest_mps = 8, kLongest_m = 1.8;
  constexpr double kMayWellBe = 0.2, kRather = 0.6;  // what is cut off looks small
  if (shape.traits.speed_mps > kFastest_mps) return ObjectKind::kUnknown;
  if (view.points && view.points->sizes().head<2>().norm() > kLongest_m) return ObjectKind::kUnknown;
  const bool cut_off = observed && isCutOff(observed->box, view.T_cam_body, camera_);
  return smallKind(shape.evidence, shape.traits, cut_off ? kRather : kMayWellBe);
}

/// Evidence of the outline on the faces, which also updates `view.box`. Empty, with the box as it was, where that makes
/// no sense.
std::optional<FaceInformation> ObjectShapes::measured(const Sight& seen, ObjectView& view, const Shape& shape) const {
  const BoxEstimate before = view.box;
  const std::vector<SurfacePoint> surface = surfacePoints(seen.disparities, seen.outline, view, camera_);
  FaceInformation look;
  for (int i = 0; i < kIterations; ++i) {
    look = measureFaces(seen, surface, view, camera_);
    FaceInformation both = shape.evidence;
    both.add(look, kLookWeight);
    view.box = estimateBox(both, shape.traits);
    const Eigen::Array3d size_m = view.box.most() - view.box.least();
    if ((size_m > kLeastSize_m).all() && (size_m < kMostSize_m).all()) continue;
    view.box = before;
    return std::nullopt;
  }
  return look;
}

/// Marks an object whose outline was found although none of its points was followed.
void ObjectShapes::markSeen(ObjectEstimate& object, const DenseEvidence& evidence) {
  object.state = evidence.state;
  object.points = evidence.cells;
}

void ObjectShapes::setBox(ObjectEstimate& object, const ObjectBox& box, const SE3& T_cam_body) const {
  object.cuboid = box;
  const Eigen::Vector3d half_m = 0.5 * box.size_m;
  const auto in_image = projectedBox(box.center_body - half_m, box.center_body + half_m, T_cam_body, camera_);
  if (in_image) object.box = *in_image;
}

std::vector<FrameEstimate> ObjectShapes::finish(std::vector<FrameEstimate> finals) {
  complete(finals);
  return finals;
}

/// Completes final frames. All their looks come first, as each frame's cuboid gathers what is around it.
void ObjectShapes::complete(std::vector<FrameEstimate>& finals) {
  for (const FrameEstimate& final : finals) addSettledSpeeds(final);
  for (const FrameEstimate& final : finals) moveLooks(final);
  for (FrameEstimate& final : finals) gatherShapes(final);
}

void ObjectShapes::addSettledSpeeds(const FrameEstimate& frame) {
  for (const ObjectEstimate& object : frame.objects)
    if (const auto shape = shapes_.find(object.track); shape != shapes_.end())
      shape->second.existence.addSettledSpeed(object.velocity_world_mps.norm(),
                                              speedSigma_mps(object, frame.T_world_cam, camera_, camera_speed_mps_));
}

/// Gathers each object's shape from what was seen of it before and after the frame.
void ObjectShapes::gatherShapes(FrameEstimate& frame) const {
  for (ObjectEstimate& object : frame.objects) {
    const auto shape = shapes_.find(object.track);
    if (shape == shapes_.end()) continue;
    const auto dense = shape->second.only_dense.find(frame.head.frame);
    if (dense != shape->second.only_dense.end() && object.state == ObjectState::kPredicted)
      markSeen(object, dense->second);
    const SE3 T_cam_body = frame.T_world_cam.inverse() * object.T_world_body;
    setBox(object, believedBox(evidenceAround(shape->second, frame.head.frame), shape->second.traits), T_cam_body);
    object.existence_probability = shape->second.existence.settledProbability(frame.head.frame);
  }
  dropLeft(frame, camera_);
  dropUnlikely(frame, params_.min_existence);
}

/// Moves looks into the body frame of the final estimate.
void ObjectShapes::moveLooks(const FrameEstimate& final) {
  for (const ObjectEstimate& object : final.objects) {
    const auto shape = shapes_.find(object.track);
    if (shape == shapes_.end()) continue;
    const auto look = shape->second.looks.find(final.head.frame);
    if (look == shape->second.looks.end()) continue;
    const SE3 T_cam_body = final.T_world_cam.inverse() * object.T_world_body;
    const Eigen::Vector3d middle_body = T_cam_body.inverse() * (look->second.T_cam_body * look->second.middle_body);
    look->second = {look->second.faces.shifted(middle_body - look->second.middle_body), middle_body, T_cam_body};
  }
}

FaceInformation ObjectShapes::evidenceAround(const Shape& shape, FrameId frame) const {
  FaceInformation evidence = shape.first;
  const auto& fadings = fadingByFrames();
  const auto end = shape.looks.upper_bound(FrameId{frame.value + kMemory_frames});
  for (auto it = shape.looks.lower_bound(FrameId{frame.value - kMemory_frames}); it != end; ++it)
    evidence.add(it->second.faces, kLookWeight * fadings[std::abs(it->first.value - frame.value)]);
  return evidence;
}

/// Forgets looks that no final estimate will ask for any more.
void ObjectShapes::forgetGone(const Estimates& estimates) {
  if (estimates.finals.empty()) return;
  const FrameId oldest{estimates.finals.back().head.frame.value - kMemory_frames};
  for (auto it = shapes_.begin(); it != shapes_.end();) {
    auto& looks = it->second.looks;
    looks.erase(looks.begin(), looks.lower_bound(oldest));
    it->second.only_dense.erase(it->second.only_dense.begin(), it->second.only_dense.lower_bound(oldest));
    it = looks.empty() && it->second.last < oldest ? shapes_.erase(it) : std::next(it);
  }
}

std::vector<Parameter> parametersOf(ObjectShapes::Params& params) {
  return {numberParameter("min_existence", params.min_existence, {0, 0.9},
                          "higher reports surer objects alone; 0 reports all, each with its probability")};
}

}  // namespace motorcade
