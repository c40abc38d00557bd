#include "apps/recorded/recorded_drive.hpp"

#include <algorithm>
#include <filesystem>
#include <span>
#include <system_error>
#include <utility>

namespace motorcade {
namespace {

constexpr double kLeastWay_m = 1.5;     // labels of parked cars wander by up to 1.3 m, at most at .4 m/s
constexpr std::size_t kLeastSteps = 5;  // of a part of a track, among which a single jump does not count

Eigen::Vector3d wayBetween(const StampedPlace& from, const StampedPlace& to) { return to.p_world - from.p_world; }

/// True when a part of a track is long enough, fast enough, and more than a jump: no step exceeds its share of the time
/// by more than half of the way.
bool goesAway(std::span<const StampedPlace> part) {
  constexpr double kJump = 0.5;
  const Eigen::Vector3d way = wayBetween(part.front(), part.back());
  const double time_s = secondsBetween(part.front().stamp, part.back().stamp), way_m = way.norm();
  if (way_m <= kLeastWay_m || way_m <= kMovingSpeed_mps * time_s) return false;
  for (std::size_t i = 1; i < part.size(); ++i) {
    const double along_m = wayBetween(part[i - 1], part[i]).dot(way) / way_m;
    if (along_m / way_m >= kJump + secondsBetween(part[i - 1].stamp, part[i].stamp) / time_s) return false;
  }
  return true;
}

/// The truth, where there is any, moved into the world of the run's first frame.
void addTruth(RecordedDrive& drive, const Sequence& sequence) {
  const auto camera = readCameraTruth(sequence);
  if (!camera || drive.first_frame < camera->first_frame || drive.first_frame >= std::ssize(camera->T_world_cam))
    return;
  const SE3 T_run_world = camera->T_world_cam[drive.first_frame].inverse();
  for (std::size_t i = 0; i < drive.T_world_cam.size(); ++i) {
    const std::size_t frame = drive.first_frame + i;
    if (frame < camera->T_world_cam.size()) drive.T_world_cam_true.push_back(T_run_world * camera->T_world_cam[frame]);
  }
  const auto truths = readObjectTruths(sequence, *camera);
  if (!truths) return;
  drive.true_movers = travelingLabels(truths->objects, sequence.stamps);
  for (ObjectTruth truth : truths->objects) {
    truth.T_world_object = T_run_world * truth.T_world_object;
    drive.true_objects[truth.frame.value - drive.first_frame].push_back(std::move(truth));
  }
}

void addCovariances(RecordedDrive& drive, const std::vector<RunFolder::CovarianceRow>& rows) {
  for (const auto& row : rows) {
    const auto objects = drive.objects.find(row.frame.value - drive.first_frame);
    if (!row.track.valid() || objects == drive.objects.end()) continue;
    for (ObjectEstimate& object : objects->second)
      if (object.track == row.track) object.covariance = row.covariance;
  }
}

std::string nameOf(const std::filesystem::path& folder) {
  std::error_code unreachable;  // then the name stays as it was given
  const auto whole = std::filesystem::absolute(folder, unreachable).lexically_normal();
  return (whole.has_filename() ? whole : whole.parent_path()).filename().string();
}

/// Builds a drive. `stamps` are those of the run's frames; poses beyond them are left out.
RecordedDrive driveOf(const RunFolder& run, std::vector<Timestamp> stamps) {
  RecordedDrive drive;
  drive.name = nameOf(run.folder);
  drive.first_frame = run.first_frame;
  const RunFolder::Trajectories& shown = fullerTrajectories(run);
  drive.T_world_cam = shown.camera;
  stamps.resize(std::min(drive.T_world_cam.size(), stamps.size()));
  drive.T_world_cam.resize(stamps.size());
  drive.stamps = std::move(stamps);
  for (const auto& row : shown.objects) drive.objects[row.frame.value - run.first_frame].push_back(row.object);
  addCovariances(drive, shown.covariances.empty() ? run.online.covariances : shown.covariances);
  const auto points = run.folder / kObjectPointsFile;
  if (std::filesystem::exists(points))
    for (const ObjectPoint& point : readObjectPoints(points))
      drive.points[point.frame.value - run.first_frame].push_back(point);
  return drive;
}

}  // namespace

bool travels(const std::vector<StampedPlace>& track) {
  const auto isAwayFrom = [&](const StampedPlace& from) {
    return [&](const StampedPlace& place) { return wayBetween(from, place).norm() > kLeastWay_m; };
  };
  if (track.empty() || std::ranges::none_of(track, isAwayFrom(track.front()))) return false;
  for (std::size_t from = 0; from + 1 < track.size(); ++from) {
    const auto away =
        std::find_if(track.begin() + static_cast<std::ptrdiff_t>(from), track.end(), isAwayFrom(track[from]));
    if (away == track.end()) continue;
    const std::size_t found = static_cast<std::size_t>(away - track.begin());
    const std::size_t to = std::min(std::max(found, from + kLeastSteps), track.size() - 1);
    const std::size_t begin = std::min(from, to - std::min(to, kLeastSteps));
    if (goesAway(std::span(track).subspan(begin, to - begin + 1))) return true;
  }
  return false;
}

std::set<std::int64_t> travelingLabels(const std::vector<ObjectTruth>& objects, const std::vector<Timestamp>& stamps) {
  std::map<std::int64_t, std::vector<StampedPlace>> tracks;
  for (const ObjectTruth& object : objects)
    if (std::cmp_less(object.frame.value, stamps.size()))
      tracks[object.id].push_back({stamps[object.frame.value], object.T_world_object.translation()});
  std::set<std::int64_t> traveling;
  for (const auto& [id, track] : tracks)
    if (travels(track)) traveling.insert(id);
  return traveling;
}

const RunFolder::Trajectories& fullerTrajectories(const RunFolder& run) {
  return run.final.camera.size() >= run.online.camera.size() ? run.final : run.online;
}

RecordedDrive recordedDrive(const RunFolder& run) {
  std::vector<Timestamp> stamps;
  for (const FrameRow& row : run.frames) stamps.push_back(row.head.stamp);
  return driveOf(run, std::move(stamps));
}

RecordedDrive recordedDrive(const RunFolder& run, const Sequence& sequence) {
  RecordedDrive drive = driveOf(run, {sequence.stamps.begin() + run.first_frame, sequence.stamps.end()});
  drive.camera = sequence.camera;
  addTruth(drive, sequence);
  return drive;
}

std::vector<ObjectEstimate> RecordedDrive::objectsAt(std::size_t frame) const {
  const auto found = objects.find(static_cast<std::int64_t>(frame));
  return found == objects.end() ? std::vector<ObjectEstimate>() : found->second;
}

std::vector<ObjectPoint> RecordedDrive::pointsAt(std::size_t frame) const {
  const auto found = points.find(static_cast<std::int64_t>(frame));
  return found == points.end() ? std::vector<ObjectPoint>() : found->second;
}

const ObjectEstimate* RecordedDrive::find(std::size_t frame, TrackId track) const {
  const auto here = objects.find(static_cast<std::int64_t>(frame));
  if (here == objects.end()) return nullptr;
  const auto found = std::ranges::find(here->second, track, &ObjectEstimate::track);
  return found == here->second.end() ? nullptr : &*found;
}

std::vector<Eigen::Vector3d> RecordedDrive::wayOf(TrackId track, const Eigen::Vector3d& p_body, std::size_t earliest,
                                                  std::size_t frame) const {
  std::vector<Eigen::Vector3d> way;
  for (auto at = objects.lower_bound(static_cast<std::int64_t>(earliest)); at != objects.end(); ++at) {
    if (std::cmp_greater(at->first, frame)) break;
    for (const auto& object : at->second)
      if (object.track == track) way.push_back(object.T_world_body * p_body);
  }
  return way;
}

}  // namespace motorcade
