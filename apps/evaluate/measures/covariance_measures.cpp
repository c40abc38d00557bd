#include "apps/evaluate/measures/covariance_measures.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <nlohmann/json.hpp>

#include "apps/evaluate/comparison/object_positions.hpp"
#include "core/assignment.hpp"
#include "core/decompositions.hpp"

namespace motorcade {

void AxisReliability::add(const Vector6d& error, const Matrix6d& covariance) {
  for (int axis = 0; axis < kAxes; ++axis) {
    const double sigmas = std::abs(error[axis]) / std::sqrt(covariance(axis, axis));
    const double probability = std::erf(sigmas / std::numbers::sqrt2);
    ++errors[axis][std::min(kTenths - 1, static_cast<int>(kTenths * probability))];
  }
}

void AxisReliability::add(const AxisReliability& other) {
  for (int axis = 0; axis < kAxes; ++axis)
    for (int tenth = 0; tenth < kTenths; ++tenth) errors[axis][tenth] += other.errors[axis][tenth];
}

int AxisReliability::samples() const { return std::accumulate(errors[0].begin(), errors[0].end(), 0); }

double AxisReliability::shareWithin(int axis, int tenths) const {
  const auto& of_axis = errors[axis];
  return static_cast<double>(std::accumulate(of_axis.begin(), of_axis.begin() + tenths, 0)) / samples();
}

nlohmann::ordered_json jsonOf(const AxisReliability& reliability) {
  nlohmann::ordered_json json;
  for (int axis = 0; axis < AxisReliability::kAxes; ++axis)
    json[AxisReliability::kAxisNames[axis]] = reliability.errors[axis];
  return json;
}

AxisReliability axisReliabilityOf(const nlohmann::json& json) {
  AxisReliability reliability;
  for (int axis = 0; axis < AxisReliability::kAxes; ++axis)
    json.at(AxisReliability::kAxisNames[axis]).get_to(reliability.errors[axis]);
  return reliability;
}

namespace {

constexpr double kChiSquare95Of6 = 12.591587, kChiSquare95Of3 = 7.814728;  // 95 % quantiles

NormalizedErrors normalizedErrors(const std::vector<double>& nees, double region) {
  const auto n = static_cast<double>(nees.size());
  const Statistics statistics = statisticsOf(nees);
  return {.mean_nees = statistics.mean,
          .median_nees = statistics.median,
          .coverage_95 =
              n > 0
                  ? static_cast<double>(std::ranges::count_if(nees, [&](double value) { return value <= region; })) / n
                  : 0};
}

double neesOf(const Eigen::Vector3d& xi, const Eigen::Matrix3d& covariance) {
  return xi.dot(covariance.inverse() * xi);
}

ErrorSample errorOf(const SeenTwice& seen, const SE3& Y) {
  const Matrix6d carried = Y.inverse().adjoint();
  return {(seen.T_cam_body.inverse() * seen.T_cam_other * Y).log(),
          seen.covariance + carried * seen.other_covariance * carried.transpose()};
}

/// The Gauss-Newton step on the right of Y.
Vector6d stepFrom(const SE3& Y, const std::vector<SeenTwice>& frames) {
  Matrix6d H = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  for (const auto& seen : frames) {
    const ErrorSample error = errorOf(seen, Y);
    const Eigen::LLT<Matrix6d> cholesky(error.covariance);
    if (cholesky.info() != Eigen::Success) continue;
    const Matrix6d J = rightJacobianInverseSE3(error.xi);
    H += J.transpose() * cholesky.solve(J);
    gradient += J.transpose() * cholesky.solve(error.xi);
  }
  const Eigen::LLT<Matrix6d> cholesky(H);
  return cholesky.info() == Eigen::Success ? Vector6d(-cholesky.solve(gradient)) : Vector6d::Zero();
}

SE3 fitOffset(const std::vector<SeenTwice>& frames) {
  constexpr int kRounds = 10;  // from the mean, which is close
  std::vector<SE3> bodies, others;
  for (const auto& seen : frames) {
    bodies.push_back(seen.T_cam_body);
    others.push_back(seen.T_cam_other);
  }
  SE3 Y = bodyOffset(others, bodies);
  for (int round = 0; round < kRounds; ++round) Y = (Y * SE3::exp(stepFrom(Y, frames))).normalized();
  return Y;
}

constexpr std::int64_t kEveryFrames = 5;

bool isTaken(FrameId frame) { return frame.value % kEveryFrames == 0; }

using CovarianceOf = std::map<std::pair<TrackId, FrameId>, Matrix6d>;

CovarianceOf byTrackAndFrame(const CovarianceRows& rows) {
  CovarianceOf covariances;
  for (const auto& row : rows) covariances[{row.track, row.frame}] = row.covariance;
  return covariances;
}

/// The frames of one pair of body frames: of a track and a label, or of two tracks.
struct SeenTrack {
  std::vector<SeenTwice> seen;
  std::vector<FrameId> frames;
};

template <class Key>
std::vector<ErrorSample> samplesOf(const std::map<Key, SeenTrack>& tracks) {
  std::vector<ErrorSample> samples;
  for (const auto& [key, track] : tracks) {
    if (track.frames.size() < kLeastFramesOfMean) continue;
    const auto errors = errorsWithoutOffset(track.seen);
    for (std::size_t i = 0; i < errors.size(); ++i)
      if (isTaken(track.frames[i])) samples.push_back(errors[i]);
  }
  return samples;
}

/// A run's online estimates, indexed by frame.
struct HalfRun {
  explicit HalfRun(const RunFolder& run) : folder(run), covariances(byTrackAndFrame(run.online.covariances)) {
    for (const auto& row : run.online.objects)
      if (covariances.contains({row.object.track, row.frame})) rows[row.frame].push_back(&row.object);
  }
  std::int64_t frames() const { return std::ssize(folder.online.camera); }
  const SE3& T_world_cam(FrameId frame) const { return folder.online.camera[frame.value - folder.first_frame]; }
  const Matrix6d* covarianceOf(TrackId track, FrameId frame) const {
    const auto found = covariances.find({track, frame});
    return found == covariances.end() ? nullptr : &found->second;
  }
  SE3 motionTo(FrameId now) const {
    return T_world_cam({now.value - kCameraCovarianceFrames}).inverse() * T_world_cam(now);
  }
  SE3 T_cam_body(const ObjectEstimate& object, FrameId frame) const {
    return T_world_cam(frame).inverse() * object.T_world_body;
  }

  const RunFolder& folder;
  CovarianceOf covariances;
  std::map<FrameId, std::vector<const ObjectEstimate*>> rows;
};

std::vector<ErrorSample> cameraDifferences(const HalfRun& a, const HalfRun& b) {
  std::vector<ErrorSample> samples;
  const std::int64_t first = a.folder.first_frame, end = first + std::min(a.frames(), b.frames());
  for (FrameId now{first + kCameraCovarianceFrames}; now.value < end; ++now.value) {
    const Matrix6d *of_a = a.covarianceOf({}, now), *of_b = b.covarianceOf({}, now);
    if (!isTaken(now) || !of_a || !of_b) continue;
    samples.push_back({(a.motionTo(now).inverse() * b.motionTo(now)).log(), *of_a + *of_b});
  }
  return samples;
}

using TrackPair = std::pair<TrackId, TrackId>;

/// Adds the objects that both runs see in a frame.
void addSeenByBoth(const HalfRun& a, const HalfRun& b, FrameId frame, std::map<TrackPair, SeenTrack>& tracks) {
  constexpr double kGate_m = 3;  // less than between two cars
  const auto of_a = a.rows.find(frame), of_b = b.rows.find(frame);
  if (of_a == a.rows.end() || of_b == b.rows.end()) return;
  const auto &rows_a = of_a->second, &rows_b = of_b->second;
  Eigen::MatrixXd cost_m(rows_a.size(), rows_b.size());
  for (std::size_t i = 0; i < rows_a.size(); ++i)
    for (std::size_t j = 0; j < rows_b.size(); ++j)
      cost_m(i, j) =
          (a.T_cam_body(*rows_a[i], frame).translation() - b.T_cam_body(*rows_b[j], frame).translation()).norm();
  const auto columns = assignMinCost(cost_m, kGate_m);
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i] < 0) continue;
    const ObjectEstimate &mine = *rows_a[i], &theirs = *rows_b[columns[i]];
    SeenTrack& track = tracks[{mine.track, theirs.track}];
    track.seen.push_back({a.T_cam_body(mine, frame), b.T_cam_body(theirs, frame), *a.covarianceOf(mine.track, frame),
                          *b.covarianceOf(theirs.track, frame)});
    track.frames.push_back(frame);
  }
}

ErrorSample motionError(const ComparedFrame& from, const ComparedFrame& to, const Matrix6d& covariance,
                        const SE3& T_true_cam) {
  const SE3 estimate = from.T_world_cam.inverse() * to.T_world_cam,
            truth = (from.T_world_cam_true * T_true_cam).inverse() * to.T_world_cam_true * T_true_cam;
  return {(estimate.inverse() * truth).log(), covariance};
}

/// The index of a row's frame; empty where there is no such frame.
std::optional<std::int64_t> placeOf(const RunFolder::CovarianceRow& row, const std::vector<ComparedFrame>& frames) {
  const std::int64_t place = frames.empty() ? -1 : row.frame.value - frames.front().frame.value;
  if (place < 0 || place >= std::ssize(frames)) return std::nullopt;
  return place;
}

/// The error of the camera's motion to a row's frame; empty where the frames do not reach back far enough.
std::optional<ErrorSample> cameraError(const std::vector<ComparedFrame>& frames, const RunFolder::CovarianceRow& row,
                                       const SE3& T_true_cam) {
  const auto now = placeOf(row, frames);
  if (row.track.valid() || !now || *now < kCameraCovarianceFrames) return std::nullopt;
  std::int64_t before = *now - kCameraCovarianceFrames;
  while (before > 0 && !frames[before].entered) --before;
  return motionError(frames[before], frames[*now], row.covariance, T_true_cam);
}

}  // namespace

CovarianceErrors consistencyOf(const std::vector<ErrorSample>& samples) {
  std::vector<double> pose, position, rotation;
  AxisReliability by_axis;
  for (const auto& sample : samples) {
    const Eigen::LLT<Matrix6d> cholesky(sample.covariance);
    if (cholesky.info() != Eigen::Success) continue;
    pose.push_back(sample.xi.dot(cholesky.solve(sample.xi)));
    position.push_back(neesOf(sample.xi.head<3>(), sample.covariance.topLeftCorner<3, 3>()));
    rotation.push_back(neesOf(sample.xi.tail<3>(), sample.covariance.bottomRightCorner<3, 3>()));
    by_axis.add(sample.xi, sample.covariance);
  }
  return {.samples = static_cast<int>(pose.size()),
          .pose = normalizedErrors(pose, kChiSquare95Of6),
          .position = normalizedErrors(position, kChiSquare95Of3),
          .rotation = normalizedErrors(rotation, kChiSquare95Of3),
          .by_axis = by_axis};
}

std::vector<ErrorSample> errorsWithoutOffset(const std::vector<SeenTwice>& frames) {
  const SE3 Y = fitOffset(frames);
  std::vector<ErrorSample> errors;
  for (const auto& seen : frames) errors.push_back(errorOf(seen, Y));
  return errors;
}

std::vector<ErrorSample> cameraErrorSamples(const std::vector<ComparedFrame>& frames, const CovarianceRows& rows,
                                            const SE3& T_true_cam) {
  std::vector<ErrorSample> samples;
  for (const auto& row : rows)
    if (isTaken(row.frame))
      if (const auto sample = cameraError(frames, row, T_true_cam)) samples.push_back(*sample);
  return samples;
}

std::vector<ErrorSample> cameraPoseSamples(const std::vector<ComparedFrame>& frames, const CovarianceRows& rows,
                                           const SE3& T_true_cam) {
  std::vector<ErrorSample> samples;
  for (const auto& row : rows) {
    const auto now = placeOf(row, frames);
    if (isTaken(row.frame) && now && *now > 0)
      samples.push_back(motionError(frames.front(), frames[*now], row.covariance, T_true_cam));
  }
  return samples;
}

std::vector<FrameNees> cameraNees(const std::vector<ComparedFrame>& frames, const CovarianceRows& rows,
                                  const SE3& T_true_cam) {
  std::vector<FrameNees> nees;
  for (const auto& row : rows) {
    const auto sample = cameraError(frames, row, T_true_cam);
    if (!sample) continue;
    const Eigen::LLT<Matrix6d> cholesky(sample->covariance);
    if (cholesky.info() == Eigen::Success) nees.push_back({row.frame, sample->xi.dot(cholesky.solve(sample->xi))});
  }
  return nees;
}

std::vector<ErrorSample> objectErrorSamples(const std::vector<ComparedFrame>& frames, const CovarianceRows& rows) {
  const CovarianceOf covariances = byTrackAndFrame(rows);
  std::map<std::pair<TrackId, std::int64_t>, SeenTrack> tracks;
  for (const auto& frame : frames) {
    for (const auto& row : frame.rows) {
      const auto covariance = covariances.find({row.row.object.track, frame.frame});
      if (row.object < 0 || !frame.objects[row.object].ever_moves || covariance == covariances.end()) continue;
      const ObjectTruth& truth = frame.objects[row.object].truth;
      SeenTrack& track = tracks[{row.row.object.track, truth.id}];
      track.seen.push_back(
          {frame.T_world_cam.inverse() * row.row.object.T_world_body, truth.T_cam_object, covariance->second});
      track.frames.push_back(frame.frame);
    }
  }
  return samplesOf(tracks);
}

HalfErrors compareHalves(const RunFolder& a, const RunFolder& b) {
  const HalfRun half_a(a), half_b(b);
  std::map<TrackPair, SeenTrack> tracks;
  for (const auto& [frame, rows] : half_a.rows) addSeenByBoth(half_a, half_b, frame, tracks);
  return {.camera = consistencyOf(cameraDifferences(half_a, half_b)), .objects = consistencyOf(samplesOf(tracks))};
}

}  // namespace motorcade
