#pragma once

#include <map>
#include <optional>
#include <vector>

#include "core/messages.hpp"
#include "core/parameters.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"
#include "frontend/shape/box_belief.hpp"
#include "frontend/shape/earlier_views.hpp"
#include "frontend/shape/existence.hpp"
#include "frontend/shape/lost_objects.hpp"
#include "frontend/shape/object_sight.hpp"
#include "frontend/shape/outline.hpp"
#include "frontend/shape/point_extent.hpp"

namespace motorcade {

/// The stage `object shapes`: looks densely at the image around each object, which gives its outline in this frame, and
/// gathers the outlines' evidence on its cuboid. Call in frame order: it remembers the objects.
class ObjectShapes {
 public:
  struct Params {
    double min_existence = 0.5;  // rows of what is less likely there are left out
  };
  ObjectShapes(const Params& params, const StereoCamera& camera)
      : params_(requireValid(params)), camera_(camera), sight_(camera), earlier_(camera) {}

  /// Results of the frame's earlier stages.
  struct Inputs {
    FeaturesPtr features;
    SceneMotionPtr scene;
    FrameMeasurementsPtr measurements;
  };
  /// Returns the estimates with cuboids, kinds, image boxes and masks. Settled and final ones get theirs from what was
  /// seen before and after their frame.
  EstimatesPtr operator()(const Inputs& inputs, const EstimatesPtr& estimates);
  /// Completes the frames that were still in the window when the drive ended.
  std::vector<FrameEstimate> finish(std::vector<FrameEstimate> finals);

 private:
  /// Evidence of one frame on an object's faces. It is in the body frame of that frame's online estimate, and of its
  /// final one from then on.
  struct Look {
    FaceInformation faces;
    Eigen::Vector3d middle_body;  // of the cuboid by this evidence and that before
    SE3 T_cam_body;
  };
  /// Evidence of a frame in which an outline that moves as predicted was found, but none of the object's points.
  struct DenseEvidence {
    ObjectState state;
    int cells;
  };
  struct Shape {
    Existence existence;
    FaceInformation first;     // before its first outline
    FaceInformation evidence;  // faded with age
    BodyTraits traits;
    SureSizes sure_sizes;
    FrameId last;
    ObjectState state = ObjectState::kMoving;  // when its points were last followed
    std::map<FrameId, Look> looks;
    std::map<FrameId, DenseEvidence> only_dense;
  };
  void lookAt(ObjectEstimate& object, const Inputs& inputs, const FrameEstimate& frame, std::vector<ObjectMask>& masks);
  ObjectView viewOf(const ObjectEstimate& object, const Inputs& inputs, const FrameEstimate& frame, Shape& shape);
  ObjectKind smallKindOf(const ObjectView& view, const ObjectObservation* observed, const Shape& shape) const;
  std::optional<FaceInformation> measured(const Sight& seen, ObjectView& view, const Shape& shape) const;
  void complete(std::vector<FrameEstimate>& finals);
  void addSettledSpeeds(const FrameEstimate& frame);
  void moveLooks(const FrameEstimate& final);
  void gatherShapes(FrameEstimate& frame) const;
  FaceInformation evidenceAround(const Shape& shape, FrameId frame) const;
  static void markSeen(ObjectEstimate& object, const DenseEvidence& evidence);
  void setBox(ObjectEstimate& object, const ObjectBox& box, const SE3& T_cam_body) const;
  void forgetGone(const Estimates& estimates);

  Params params_;
  StereoCamera camera_;
  ObjectSight sight_;
  EarlierViews earlier_;
  LostObjects lost_;
  std::vector<ObjectEstimate> predicted_;  // lost ones in the newest frame
  double camera_speed_mps_ = 0;            // in the newest frame
  std::map<TrackId, Shape> shapes_;
};

std::vector<Parameter> parametersOf(ObjectShapes::Params& params);

}  // namespace motorcade
