#pragma once

#include <deque>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "core/messages.hpp"
#include "core/parameters.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"
#include "frontend/shape/box_belief.hpp"
#include "frontend/shape/dense_disparity.hpp"
#include "frontend/shape/existence.hpp"
#include "frontend/shape/outline.hpp"
#include "frontend/shape/recent_frames.hpp"

namespace motorcade {

/// The stage `object shapes`: looks densely at the image around each object, which gives its outline in this frame, and
/// gathers what the outlines say of its cuboid. Call in frame order: it remembers the objects.
class ObjectShapes {
 public:
  struct Params {
    double min_existence = 0.5;  // rows of what is less likely there are left out
  };
  ObjectShapes(const Params& params, const StereoCamera& camera) : params_(requireValid(params)), camera_(camera) {}

  /// What the frame's earlier stages made.
  struct Inputs {
    FeaturesPtr features;
    SceneMotionPtr scene;
    FrameMeasurementsPtr measurements;
  };
  /// The estimates with cuboids, kinds, image boxes and masks. Settled and final ones get theirs from what was seen
  /// before and after their frame.
  EstimatesPtr operator()(const Inputs& inputs, const EstimatesPtr& estimates);
  /// The same for the frames that were still in the window when the drive ended.
  std::vector<FrameEstimate> finish(std::vector<FrameEstimate> finals);

 private:
  /// What one frame said of an object's faces, in the body frame of that frame's online estimate, and of its final
  /// one from then on.
  struct Look {
    FaceInformation faces;
    SE3 T_cam_body;
  };
  /// Of a frame in which an outline that moves as predicted was found, but none of the object's points.
  struct DenseEvidence {
    ObjectState state;
    int cells;
  };
  /// Where an object was in a frame.
  struct Place {
    FrameId frame;
    SE3 T_cam_body;
  };
  struct Shape {
    Existence existence;
    FaceInformation first;     // before its first outline
    FaceInformation evidence;  // faded with age
    double speed_mps = 0;
    std::deque<Place> places;                  // in the last frames, the oldest first
    ObjectState state = ObjectState::kMoving;  // when its points were last followed
    std::map<FrameId, Look> looks;
    std::map<FrameId, DenseEvidence> only_dense;
  };
  /// What the images show of an object.
  struct Sight {
    LevelDisparities disparities;
    Outline outline;
  };
  static const ObjectObservation* observationOf(TrackId track, FrameId frame, const Inputs& inputs);
  void lookAt(ObjectEstimate& object, const Inputs& inputs, const FrameEstimate& frame, std::vector<ObjectMask>& masks);
  ObjectView viewOf(const ObjectEstimate& object, const Inputs& inputs, const FrameEstimate& frame, Shape& shape) const;
  std::optional<ObjectView::Before> beforeIn(const RecentFrames::Frame& then, const Shape& shape,
                                             const ObjectView& view, const Features& now) const;
  std::optional<ObjectView::Before> wellBefore(const Shape& shape, const ObjectView& view, const Features& now) const;
  std::vector<ObjectView::Other> cuboidsBeside(TrackId track, const FrameEstimate& frame,
                                               const std::optional<ObjectView::Before>& before) const;
  std::optional<Box> usualBox(const ObjectView& view) const;
  std::optional<Sight> sightOf(const ObjectView& view, const Features& features);
  std::optional<FaceInformation> measured(const Sight& seen, ObjectView& view, const Shape& shape) const;
  std::optional<LevelDisparities> disparitiesAround(const ObjectView& view, const Features& features);
  static void refine(LevelDisparities& disparities, std::span<const int> cells, const Features& features);
  void complete(std::vector<FrameEstimate>& finals);
  void moveLooks(const FrameEstimate& final);
  void gatherShapes(FrameEstimate& frame) const;
  FaceInformation evidenceAround(const Shape& shape, FrameId frame) const;
  static void markSeen(ObjectEstimate& object, const DenseEvidence& evidence);
  void setBox(ObjectEstimate& object, const BoxEstimate& box, const SE3& T_cam_body) const;
  void forgetGone(const Estimates& estimates);

  double speedSigma_mps(const ObjectEstimate& object, const SE3& T_world_cam) const;
  MotionVerdict verdictOn(const ObjectView& view, const ObjectObservation* observed,
                          const std::optional<Sight>& seen) const;
  void settleMotion(const FrameEstimate& frame);
  void dropUnlikely(FrameEstimate& frame) const;

  Params params_;
  StereoCamera camera_;
  DenseDisparity dense_disparity_;
  RecentFrames recent_;
  std::map<TrackId, Shape> shapes_;
};

std::vector<Parameter> parametersOf(ObjectShapes::Params& params);

}  // namespace motorcade
