#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/evaluate/comparison/followed_objects.hpp"
#include "apps/evaluate/comparison/object_measures.hpp"
#include "apps/evaluate/comparison/object_positions.hpp"
#include "apps/evaluate/comparison/trajectory_error.hpp"
#include "apps/evaluate/comparison/truth_check.hpp"
#include "apps/evaluate/measures/acceleration_measures.hpp"
#include "apps/evaluate/measures/belief_measures.hpp"
#include "apps/evaluate/measures/covariance_measures.hpp"
#include "apps/evaluate/measures/shape_measures.hpp"
#include "apps/evaluate/measures/tracking_measures.hpp"
#include "apps/evaluate/measures/worst_frames.hpp"
#include "io/results/run_folder.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

struct EvaluateOptions {
  std::filesystem::path run, sequence;  // the sequence that the run names when empty
  std::optional<double> fps_hz;         // of a sequence without times; the run's when empty
  OxtsTimes truth = OxtsTimes::kInterpolated;
  std::filesystem::path baseline;      // camera poses to compare with; empty for none
  std::filesystem::path baseline_run;  // run folder to compare objects with; empty for none
  std::filesystem::path half_run;      // run folder of the same drive from other points; empty for none
  std::filesystem::path export_truth;  // folder for the true trajectories; empty for none
  std::filesystem::path export_kitti;  // folder for the run's objects as KITTI results; empty for none
  std::filesystem::path json;          // empty for none
};

/// The covariances of one kind of estimate, see covariance_measures.hpp.
struct CovarianceEvaluation {
  CovarianceErrors camera, objects;
  CovarianceErrors camera_pose;                             // since the run's first frame, without mounting
  std::optional<CovarianceErrors> camera_mounted;           // without the truth's mounting error
  std::optional<CovarianceErrors> camera_with_truth_noise;  // also with the truth's noise added, see truthNoise
};

/// All measures of one kind of estimate, final or online.
struct KindEvaluation {
  std::size_t frames = 0;
  std::optional<TrajectoryErrors> camera;
  std::optional<TrajectoryErrors> camera_mounted;  // without the truth's mounting error, where it may have one
  std::optional<SegmentErrors> camera_segments, camera_mounted_segments;
  double course_difference_deg = 0;  // between the camera's path and the true one, each as its camera sees it
  std::vector<ObjectErrors> objects;
  MeanPositionErrors mean_positions;
  MotionErrors motion;
  FollowedMotion followed_motion;
  std::optional<AccelerationErrors> acceleration;  // where the truth is exact
  DetectionErrors detection;
  Reliability existence;
  BoxErrors boxes_within_30m, boxes_from_30_to_50m;
  Hota image_within_30m, image_within_50m, footprint_within_30m, footprint_within_50m;
  KindErrors kinds_within_30m;
  FirstReports first_within_30m, first_within_50m;
  CovarianceEvaluation covariances{};  // of a run
};

/// (ATE_baseline - ATE_ours) / ATE_baseline of the camera's final path, SE(3) aligned RMSE.
struct RelativeError {
  double ours_m = 0, baseline_m = 0;
  double relative() const { return baseline_m > 0 ? (baseline_m - ours_m) / baseline_m : 0; }
};

struct Evaluation {
  std::filesystem::path run, sequence;
  bool complete = false;
  std::int64_t first_frame = 0;
  std::size_t frames_run = 0;        // with an online pose
  std::size_t finals_recovered = 0;  // of the last frames of a run that did not end in order, from online
  int lost = 0, rejected = 0, dropped = 0;
  std::string camera_source, object_source;  // the latter empty without labels
  std::optional<TruthCheck> truth_check;     // where the truth is not from velocities, and these are known
  KindEvaluation final, online;
  WorstFrames worst;                      // of the final estimates
  std::optional<SE3> mounting;            // T_true_cam, fitted to the final path; empty where the truth is exact
  std::vector<FrameNees> camera_nees;     // online
  std::optional<HalfErrors> half_errors;  // against the other half's run
  std::optional<MaskEvaluation> masks;    // where the run has some, and the truth too
  std::optional<RelativeError> camera_against_baseline;
  std::optional<RunComparison> objects_against_baseline;  // final estimates
  std::vector<double> latency_ms;                         // sorted
  double latencyQuantile_ms(double part) const;
};

/// Measures a run against the truth of its sequence. Throws InputError where one of them cannot be read or is missing.
Evaluation evaluateRun(const EvaluateOptions& options);

/// The same for camera poses alone, frame i of the sequence in line i.
KindEvaluation evaluatePoses(const std::vector<SE3>& poses, const Sequence& sequence,
                             OxtsTimes times = OxtsTimes::kInterpolated);

/// A baseline's poses of a run's frames. The file has a pose for each frame of the sequence or of the run, or is a
/// trajectory with times, which may end earlier. Throws InputError.
std::vector<SE3> baselinePoses(const std::filesystem::path& file, std::int64_t first_frame, std::size_t frames_run,
                               const Sequence& sequence);

}  // namespace motorcade
