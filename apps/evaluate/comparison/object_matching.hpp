#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <vector>

#include "core/messages.hpp"
#include "io/results/run_folder.hpp"
#include "io/truth/ground_truth.hpp"

/// Brings a run's object rows and the labels together, frame by frame.
namespace motorcade {

/// Bounds of the two ranges that objects are measured in.
inline constexpr double kNear_m = 30, kFar_m = 50;

/// A label in one frame, with the properties that the measures need.
struct TrueObject {
  ObjectTruth truth;
  bool counted = false;     // well enough in view to be asked for
  bool moving = false;      // in this frame
  bool ever_moves = false;  // in some frame
  double speed_mps = 0;     // over +/-3 frames
  int visible_before = 0;   // counted frames of this label before this one
  double range_m() const;   // from the camera, on the ground
  bool asked() const { return counted && moving; }
};

/// True for a row of an object that was seen, not only predicted or hardly seen.
inline bool isReported(const ObjectEstimate& object) {
  return object.state != ObjectState::kPredicted && object.points >= 3;
}

/// One row of the run and the label that it was matched to.
struct MatchedRow {
  RunFolder::ObjectRow row;
  int object = -1;  // index into the frame's true objects, or none
  double distance_m = 0, gate_m = 1;
  bool in_ignored_area = false;  // unmatched, mostly inside a DontCare box
  bool reported() const { return isReported(row.object); }
};

/// A frame of the comparison. The camera poses are in the world of the run: its first frame.
struct ComparedFrame {
  FrameId frame;
  SE3 T_world_cam, T_world_cam_true;
  std::vector<TrueObject> objects;
  std::vector<MatchedRow> rows;
  bool entered = true;  // the pipeline: others have no part in covariances
};

/// A match of a row with a label.
struct AskedPair {
  const ComparedFrame* frame;
  const TrueObject* object;
  const MatchedRow* row;
};
/// Reported rows on labels that are asked for, at least `from_m` away and nearer than `to_m`, in the order of the
/// frames.
std::vector<AskedPair> askedPairs(const std::vector<ComparedFrame>& frames, double from_m = 0,
                                  double to_m = std::numeric_limits<double>::infinity());

/// Rows of any state on labels that move, whatever their occlusion, in the order of the frames.
std::vector<AskedPair> movingPairs(const std::vector<ComparedFrame>& frames);

/// The number of rows of the same track that come before each row.
std::map<const MatchedRow*, int> rowsBefore(const std::vector<ComparedFrame>& frames);
/// Rows of a track before those that count for a quantity that needs several views.
inline constexpr int kEarlyRows = 9;

/// Labels with their motion, from all frames of the sequence. `stamps` are the frames' times.
std::map<FrameId, std::vector<TrueObject>> describeObjects(const ObjectTruths& truths,
                                                           const std::vector<Timestamp>& stamps);

/// Every frame that has a camera pose in `trajectories` and in `camera`, with its rows matched one to one to labels.
/// The matching takes as many pairs as possible within the gate max(3 m, half the length + 0.08 z), then the least
/// total distance. Distances are on the ground as seen from the camera, from the middle of a row's cuboid, or else from
/// the body's origin. Without labels the frames have no objects.
std::vector<ComparedFrame> compareFrames(const RunFolder::Trajectories& trajectories, std::int64_t first_frame,
                                         const CameraTruth& camera, const ObjectTruths* truths,
                                         const std::vector<Timestamp>& stamps);

}  // namespace motorcade
