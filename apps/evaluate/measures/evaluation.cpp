#include "apps/evaluate/measures/evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "apps/recorded/recorded_run.hpp"
#include "io/files/errors.hpp"
#include "io/files/file_descriptor.hpp"
#include "io/files/line_file.hpp"
#include "io/files/number_text.hpp"
#include "io/sequence/pose_interpolation.hpp"
#include "io/truth/stamped_poses.hpp"
#include "io/truth/trajectory.hpp"

namespace motorcade {
namespace {

struct CameraPaths {
  explicit CameraPaths(const std::vector<ComparedFrame>& frames) {
    for (const auto& frame : frames) {
      estimate.push_back(frame.T_world_cam);
      truth.push_back(frame.T_world_cam_true);
    }
  }
  std::vector<SE3> estimate, truth;
};

/// True unless the truth is exact. Rendered drives come with the objects' exact poses; the truth of real ones is
/// another instrument's.
bool mayBeMountedWrongly(const Sequence& sequence) { return !sequence.truth.exact(); }

void measureMounted(KindEvaluation& kind, const CameraPaths& paths, const SE3& T_true_cam) {
  const auto truth = withMounting(paths.truth, T_true_cam);
  kind.camera_mounted = trajectoryErrors(paths.estimate, truth);
  kind.camera_mounted_segments = segmentErrors(paths.estimate, truth);
}

void removeMounting(Evaluation& evaluation, const std::vector<ComparedFrame>& final,
                    const std::vector<ComparedFrame>& online) {
  const CameraPaths of_final(final), of_online(online);
  const CameraPaths& fitted = final.empty() ? of_online : of_final;
  const SE3 T_true_cam = fitMounting(fitted.estimate, fitted.truth);
  evaluation.mounting = T_true_cam;
  measureMounted(evaluation.final, of_final, T_true_cam);
  measureMounted(evaluation.online, of_online, T_true_cam);
}

/// The noise of the truth's positions; zero without velocities beside them.
Eigen::Matrix3d placeNoiseOf(const Sequence& sequence, const CameraTruth& camera, OxtsTimes truth) {
  if (truth == OxtsTimes::kVelocities || sequence.truth.oxts.empty()) return Eigen::Matrix3d::Zero();
  try {
    const auto by_velocity = readCameraTruth(sequence, OxtsTimes::kVelocities);
    return by_velocity ? placeNoise(camera.T_world_cam, by_velocity->T_world_cam) : Eigen::Matrix3d::Zero();
  } catch (const InputError&) {
    return Eigen::Matrix3d::Zero();  // packets without velocities or times are no fault here
  }
}

/// Evaluates covariances. `mounting`, of the truth, is empty where the truth is exact.
CovarianceEvaluation evaluateCovariances(const std::vector<ComparedFrame>& frames,
                                         const RunFolder::Trajectories& trajectories,
                                         const std::optional<SE3>& mounting, const Eigen::Matrix3d& place_noise) {
  const CovarianceRows& rows = trajectories.covariances;
  const SE3 T_true_cam = mounting.value_or(SE3{});
  CovarianceEvaluation evaluation;
  evaluation.camera = consistencyOf(cameraErrorSamples(frames, rows));
  evaluation.camera_pose = consistencyOf(cameraPoseSamples(frames, trajectories.pose_covariances, T_true_cam));
  evaluation.objects = consistencyOf(objectErrorSamples(frames, rows));
  if (!mounting) return evaluation;
  auto samples = cameraErrorSamples(frames, rows, T_true_cam);
  evaluation.camera_mounted = consistencyOf(samples);
  const CameraPaths paths(frames);
  Matrix6d noise = truthNoise(paths.estimate, withMounting(paths.truth, T_true_cam));
  noise.topLeftCorner<3, 3>() += place_noise;
  for (auto& sample : samples) sample.covariance += noise;
  evaluation.camera_with_truth_noise = consistencyOf(samples);
  return evaluation;
}

struct ComparedRun {
  const RunFolder& folder;
  const std::vector<ComparedFrame>&online, &final;
};

void evaluateCovariances(Evaluation& evaluation, const ComparedRun& run, const Eigen::Matrix3d& place_noise) {
  const std::optional<SE3>& mounting = evaluation.mounting;
  evaluation.camera_nees = cameraNees(run.online, run.folder.online.covariances, mounting.value_or(SE3{}));
  evaluation.online.covariances = evaluateCovariances(run.online, run.folder.online, mounting, place_noise);
  evaluation.final.covariances = evaluateCovariances(run.final, run.folder.final, mounting, place_noise);
}

KindEvaluation evaluateFrames(const std::vector<ComparedFrame>& frames) {
  const CameraPaths paths(frames);
  KindEvaluation kind{.frames = frames.size(),
                      .camera = trajectoryErrors(paths.estimate, paths.truth),
                      .camera_mounted = {},
                      .camera_segments = segmentErrors(paths.estimate, paths.truth),
                      .camera_mounted_segments = {},
                      .course_difference_deg = courseDifference_deg(paths.estimate, paths.truth),
                      .objects = objectErrors(frames),
                      .mean_positions = {},
                      .motion = motionErrors(frames),
                      .followed_motion = followedMotion(frames),
                      .acceleration = {},
                      .detection = detectionErrors(frames),
                      .existence = existenceErrors(frames),
                      .boxes_within_30m = boxErrors(frames, 0, kNear_m),
                      .boxes_from_30_to_50m = boxErrors(frames, kNear_m, kFar_m),
                      .image_within_30m = movingObjectsHota(frames, HotaBox::kImage, kNear_m),
                      .image_within_50m = movingObjectsHota(frames, HotaBox::kImage, kFar_m),
                      .footprint_within_30m = movingObjectsHota(frames, HotaBox::kFootprint, kNear_m),
                      .footprint_within_50m = movingObjectsHota(frames, HotaBox::kFootprint, kFar_m),
                      .kinds_within_30m = kindErrors(frames, kNear_m),
                      .first_within_30m = firstReports(frames, kNear_m),
                      .first_within_50m = firstReports(frames, kFar_m)};
  std::vector<PositionErrors> positions;
  for (const auto& object : kind.objects)
    if (object.positions) positions.push_back(*object.positions);
  kind.mean_positions = meanOf(positions);
  return kind;
}

/// Errors of accelerations where the truth is exact. Labels of real drives jitter too much to be derived twice.
std::optional<AccelerationErrors> accelerationsOf(const std::vector<ComparedFrame>& frames, const Sequence& sequence) {
  if (!sequence.truth.exact()) return std::nullopt;
  return accelerationErrors(frames, sequence.stamps);
}

CameraTruth neededTruth(const Sequence& sequence, OxtsTimes times) {
  auto truth = readCameraTruth(sequence, times);
  if (!truth && times == OxtsTimes::kVelocities)
    throw InputError(sequence.folder.string() +
                     ": has no velocities; --truth velocity needs oxts, and Tr_imu_velo in the calibration");
  if (!truth)
    throw InputError(sequence.folder.string() +
                     ": has no ground truth; poses.txt or oxts with their calibration are needed");
  return *std::move(truth);
}

/// Throws unless the truth knows the run's first frame. Poses are compared in the frame of the run's first camera.
void requireTruthFrom(std::int64_t first_frame, const CameraTruth& camera) {
  if (first_frame < camera.first_frame || first_frame >= std::ssize(camera.T_world_cam))
    throw InputError(camera.source + ": tells of the frames from " + std::to_string(camera.first_frame) + " up to " +
                     std::to_string(std::ssize(camera.T_world_cam) - 1) + ", the run begins with frame " +
                     std::to_string(first_frame) + "; run --frames " + std::to_string(camera.first_frame) + ":" +
                     std::to_string(std::ssize(camera.T_world_cam)));
}

void compareCameras(Evaluation& evaluation, const KindEvaluation& baseline) {
  if (!evaluation.final.camera || !baseline.camera) return;
  evaluation.camera_against_baseline = {evaluation.final.camera->ate_m.rmse, baseline.camera->ate_m.rmse};
}

void countFrames(Evaluation& evaluation, const RunFolder& run) {
  evaluation.complete = run.complete();
  evaluation.first_frame = run.first_frame;
  evaluation.frames_run = std::max(run.online.camera.size(), run.final.camera.size());
  for (const auto& frame : run.frames) {
    evaluation.lost += frame.head.status == FrameStatus::kLost;
    evaluation.rejected += frame.head.status == FrameStatus::kRejected;
    evaluation.dropped += frame.head.status == FrameStatus::kDropped;
    if (frame.head.status == FrameStatus::kGood || frame.head.status == FrameStatus::kLost)
      evaluation.latency_ms.push_back(frame.latency_ms);
  }
  std::ranges::sort(evaluation.latency_ms);
}

/// The known poses at the times of the run's frames, up to the last known one.
std::vector<SE3> posesOfRun(const StampedPoses& known, const std::filesystem::path& file,
                            std::span<const Timestamp> stamps, std::size_t frames_run) {
  if (known.stamps.size() < 2 || stamps.empty() || known.stamps.front() > stamps.front())
    throw InputError(file.string() + ": has no pose of the time of the run's first frame");
  std::vector<SE3> poses;
  for (const Timestamp stamp : stamps.first(std::min(frames_run, stamps.size())))
    if (stamp <= known.stamps.back()) poses.push_back(poseAt(stamp, known.poses, known.stamps));
  return poses;
}

std::string truthRow(const TrueObject& object) {
  std::string row;
  appendInteger(row, object.truth.frame.value);
  row += ',';
  appendInteger(row, object.truth.id);
  row.append(",").append(object.truth.type).append(object.moving ? ",1" : ",0");
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) {
      row += ',';
      appendFixed(
          row, j < 3 ? object.truth.T_world_object.rotation()(i, j) : object.truth.T_world_object.translation()[i], 9);
    }
  }
  return row;
}

/// Writes `camera_truth.txt`, `objects_truth.csv` and an `object_ID.tum` for every labeled object.
void exportTruth(const std::filesystem::path& folder, const Sequence& sequence, const CameraTruth& camera,
                 const std::optional<ObjectTruths>& truths) {
  makeFolder(folder);
  writeKittiPoses(folder / "camera_truth.txt", camera.T_world_cam);
  if (!truths) return;
  LineFile table(folder / "objects_truth.csv");
  table.writeLine("frame,id,type,moving,r00,r01,r02,tx,r10,r11,r12,ty,r20,r21,r22,tz");
  std::map<std::int64_t, std::vector<std::string>> tum;
  for (const auto& [frame, objects] : describeObjects(*truths, sequence.stamps)) {
    for (const auto& object : objects) {
      table.writeLine(truthRow(object));
      tum[object.truth.id].push_back(tumLine(sequence.stamps[frame.value], object.truth.T_world_object));
    }
  }
  table.close();
  for (const auto& [id, lines] : tum) {
    LineFile out(folder / ("object_" + std::to_string(id) + ".tum"));
    for (const auto& line : lines) out.writeLine(line);
    out.close();
  }
}

}  // namespace

std::vector<SE3> baselinePoses(const std::filesystem::path& file, std::int64_t first_frame, std::size_t frames_run,
                               const Sequence& sequence) {
  if (const auto known = readTimedPoses(file, sequence))
    return posesOfRun(*known, file, {sequence.stamps.begin() + first_frame, sequence.stamps.end()}, frames_run);
  std::vector<SE3> poses = readKittiPoses(file);
  const std::size_t sequence_frames = sequence.frames.size();
  if (poses.size() == sequence_frames) {
    poses.erase(poses.begin(), poses.begin() + std::min<std::ptrdiff_t>(first_frame, std::ssize(poses)));
  } else if (poses.size() != frames_run) {
    throw InputError(file.string() + ": has " + std::to_string(poses.size()) + " poses; the sequence has " +
                     std::to_string(sequence_frames) + " frames and the run " + std::to_string(frames_run));
  }
  poses.resize(std::min(poses.size(), frames_run));
  return poses;
}

double Evaluation::latencyQuantile_ms(double part) const {
  if (latency_ms.empty()) return 0;
  return latency_ms[std::lround(part * static_cast<double>(latency_ms.size() - 1))];
}

KindEvaluation evaluatePoses(const std::vector<SE3>& poses, const Sequence& sequence, OxtsTimes times) {
  const CameraTruth camera = neededTruth(sequence, times);
  return evaluateFrames(compareFrames({.camera = poses}, 0, camera, nullptr, sequence.stamps));
}

Evaluation evaluateRun(const EvaluateOptions& options) {
  RunFolder run = readRunFolder(options.run);
  const Sequence sequence = openSequenceOf(run, {options.sequence, options.fps_hz});
  const CameraTruth camera = neededTruth(sequence, options.truth);
  requireTruthFrom(run.first_frame, camera);
  const auto truths = readObjectTruths(sequence, camera);
  const auto compare = [&](const RunFolder::Trajectories& trajectories, std::int64_t first_frame) {
    return compareFrames(trajectories, first_frame, camera, truths ? &*truths : nullptr, sequence.stamps);
  };
  Evaluation evaluation;
  evaluation.run = options.run;
  evaluation.sequence = sequence.folder;
  evaluation.camera_source = camera.source;
  if (options.truth != OxtsTimes::kVelocities) evaluation.truth_check = checkTruth(sequence, camera);
  evaluation.finals_recovered = recoverFinals(run);
  if (truths) evaluation.object_source = truths->source;
  countFrames(evaluation, run);
  auto online = compare(run.online, run.first_frame);
  const auto final = compare(run.final, run.first_frame);
  for (std::size_t i = 0; i < std::min(online.size(), run.frames.size()); ++i)
    online[i].entered =
        run.frames[i].head.cause != FrameCause::kTooLate && run.frames[i].head.cause != FrameCause::kOutOfOrder;
  evaluation.online = evaluateFrames(online);
  evaluation.final = evaluateFrames(final);
  evaluation.online.acceleration = accelerationsOf(online, sequence);
  evaluation.final.acceleration = accelerationsOf(final, sequence);
  evaluation.worst = worstFrames(final);
  if (mayBeMountedWrongly(sequence)) removeMounting(evaluation, final, online);
  evaluateCovariances(evaluation, {run, online, final}, placeNoiseOf(sequence, camera, options.truth));
  if (!sequence.truth.instances.empty())
    evaluation.masks = maskErrors(online, options.run / "masks", sequence.truth.instances);
  if (!options.half_run.empty()) {
    const RunFolder half = readRunFolder(options.half_run);
    requireSameDrive(half, sequence);
    evaluation.half_errors = compareHalves(run, half);
  }
  if (!options.baseline.empty()) {
    const auto poses = baselinePoses(options.baseline, run.first_frame, run.final.camera.size(), sequence);
    compareCameras(evaluation, evaluateFrames(compare({.camera = poses}, run.first_frame)));
  }
  if (!options.baseline_run.empty()) {
    const RunFolder other = readRunFolder(options.baseline_run);
    requireSameDrive(other, sequence);
    const auto theirs = compare(other.final, other.first_frame);
    if (options.baseline.empty()) compareCameras(evaluation, evaluateFrames(theirs));
    evaluation.objects_against_baseline = compareRuns(followedLabels(final), followedLabels(theirs));
  }
  if (!options.export_truth.empty()) exportTruth(options.export_truth, sequence, camera, truths);
  return evaluation;
}

}  // namespace motorcade
