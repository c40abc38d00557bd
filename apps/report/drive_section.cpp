#include <algorithm>
#include <map>
#include <set>

#include <Eigen/Eigenvalues>
#include <fmt/format.h>

#include "apps/draw/palette.hpp"
#include "apps/draw/views.hpp"
#include "apps/evaluate/comparison/trajectory_error.hpp"
#include "apps/html/html_page.hpp"
#include "apps/html/svg_chart.hpp"
#include "apps/report/report_command.hpp"
#include "core/object_place.hpp"
#include "io/files/errors.hpp"

namespace motorcade {
namespace {

constexpr std::size_t kMostSpeedCharts = 24;
constexpr std::int64_t kAround = 3;    // frames before and after, of a true speed, as in the measures
constexpr std::size_t kLeastRows = 5;  // of an object with a chart of its own

/// Color of a track as in pictures, but strong enough to show on the page's background.
std::string colorOf(std::int64_t track) {
  const Color color = trackColor({track});
  return fmt::format("color-mix(in srgb,rgb({},{},{}) var(--strength),black)", color.red, color.green, color.blue);
}

/// A line that is broken where frames are missing between its points.
class LineOverFrames {
 public:
  explicit LineOverFrames(ChartLine& line) : line_(line) {}

  void add(std::int64_t frame, const Eigen::Vector2d& point, std::optional<double> half_width = {}) {
    if (!line_.points.empty() && frame > last_ + 1) {
      line_.points.push_back(lineBreak());
      if (half_width) line_.half_width.push_back(0);
    }
    line_.points.push_back(point);
    if (half_width) line_.half_width.push_back(*half_width);
    last_ = frame;
  }

 private:
  ChartLine& line_;
  std::int64_t last_ = 0;
};

/// Axes of the map in the world: x along the drive, y to the left of it.
Eigen::Matrix<double, 2, 3> mapAxes(const std::vector<SE3>& path) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const SE3& pose : path) mean += Eigen::Vector2d(pose.translation().x(), pose.translation().z());
  mean /= static_cast<double>(std::max<std::size_t>(1, path.size()));
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (const SE3& pose : path) {
    const Eigen::Vector2d from = Eigen::Vector2d(pose.translation().x(), pose.translation().z()) - mean;
    spread += from * from.transpose();
  }
  Eigen::Vector2d along = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>().computeDirect(spread).eigenvectors().col(1);
  const bool stands = spread.trace() < 1e-6;
  if (stands) along = {0, 1};
  if (!stands && along.dot(Eigen::Vector2d(path.back().translation().x() - path.front().translation().x(),
                                           path.back().translation().z() - path.front().translation().z())) < 0)
    along = -along;
  Eigen::Matrix<double, 2, 3> axes;
  axes << along.x(), 0, along.y(), -along.y(), 0, along.x();
  return axes;
}

std::vector<Eigen::Vector2d> onMap(const std::vector<SE3>& path, const Eigen::Matrix<double, 2, 3>& axes) {
  std::vector<Eigen::Vector2d> points;
  for (const SE3& pose : path) points.emplace_back(axes * pose.translation());
  return points;
}

/// Moves another path of the camera onto the estimated one as a whole.
SE3 ontoPath(std::vector<SE3> other, std::vector<SE3> path) {
  const std::size_t count = std::min(other.size(), path.size());
  other.resize(count);
  path.resize(count);
  return count > 2 ? alignPositions(other, path) : SE3();
}

std::vector<SE3> moved(const SE3& T, std::vector<SE3> path) {
  for (SE3& pose : path) pose = T * pose;
  return path;
}

struct TrackRow {
  std::int64_t frame = 0;
  const ObjectEstimate* object = nullptr;
};

std::map<std::int64_t, std::vector<TrackRow>> rowsByTrack(const RecordedDrive& drive) {
  std::map<std::int64_t, std::vector<TrackRow>> tracks;
  for (const auto& [frame, objects] : drive.objects)
    for (const ObjectEstimate& object : objects) tracks[object.track.value].push_back({frame, &object});
  return tracks;
}

void addObjects(std::vector<ChartLine>& lines, const RecordedDrive& drive, const Eigen::Matrix<double, 2, 3>& axes) {
  for (const auto& [track, rows] : rowsByTrack(drive)) {
    ChartLine line{.name = "", .color = colorOf(track)};
    LineOverFrames points(line);
    for (const TrackRow& row : rows) points.add(row.frame, axes * placeOf(*row.object).center_world);
    if (rows.size() >= kLeastRows) line.mark = fmt::format("{}", track);
    lines.push_back(std::move(line));
  }
}

void addTruth(std::vector<ChartLine>& lines, const RecordedDrive& drive, const Eigen::Matrix<double, 2, 3>& axes) {
  const SE3 T_run_truth = ontoPath(drive.T_world_cam_true, drive.T_world_cam);
  for (const std::int64_t label : drive.true_movers) {
    ChartLine line{.name = "", .color = "var(--truth)", .dashed = true};
    LineOverFrames points(line);
    for (const auto& [frame, objects] : drive.true_objects)
      for (const ObjectTruth& object : objects)
        if (object.id == label && std::cmp_less(frame, drive.T_world_cam.size()))
          points.add(frame, axes * (T_run_truth * object.T_world_object.translation()));
    lines.push_back(std::move(line));
  }
  if (!drive.T_world_cam_true.empty())
    lines.push_back({.name = "truth",
                     .color = "var(--truth)",
                     .points = onMap(moved(T_run_truth, drive.T_world_cam_true), axes),
                     .dashed = true});
}

std::string driveMap(const ReportedRun& reported) {
  const RecordedDrive& drive = reported.drive;
  const auto axes = mapAxes(drive.T_world_cam);
  std::vector<ChartLine> lines;
  addObjects(lines, drive, axes);
  addTruth(lines, drive, axes);
  if (!reported.baseline.empty())
    lines.push_back({.name = "baseline",
                     .color = "var(--ink)",
                     .points = onMap(moved(ontoPath(reported.baseline, drive.T_world_cam), reported.baseline), axes)});
  lines.push_back({.name = "camera", .color = "var(--line1)", .points = onMap(drive.T_world_cam, axes)});
  std::string others = drive.T_world_cam_true.empty() ? "" : "the truth, dashed";
  if (!reported.baseline.empty()) others += others.empty() ? "the baseline" : ", and the baseline";
  return chartFigure(
      lineChart({.x = "m along the drive", .y = "m to the left", .equal_scales = true}, lines),
      "The drive from above: the camera and each followed object in its color, with its number where it was last seen" +
          std::string(others.empty() ? "." : "; " + others + ", moved onto the camera's path as a whole."));
}

/// Speeds of a label by frame, as central differences over the frames around each.
std::map<std::int64_t, double> trueSpeeds_mps(const RecordedDrive& drive, std::int64_t label) {
  std::map<std::int64_t, Eigen::Vector3d> places;
  for (const auto& [frame, objects] : drive.true_objects)
    for (const ObjectTruth& object : objects)
      if (object.id == label) places[frame] = object.T_world_object.translation();
  std::map<std::int64_t, double> speeds;
  for (const auto& [frame, place] : places) {
    const auto before = places.find(frame - kAround), after = places.find(frame + kAround);
    if (before == places.end() || after == places.end() || std::cmp_greater_equal(after->first, drive.stamps.size()))
      continue;
    speeds[frame] = (after->second - before->second).norm() /
                    secondsBetween(drive.stamps[before->first], drive.stamps[after->first]);
  }
  return speeds;
}

std::optional<std::int64_t> labelOf(const ReportedRun& reported, std::int64_t track) {
  if (!reported.evaluation) return {};
  for (const ObjectErrors& object : reported.evaluation->final.objects)
    if (object.track.value == track) return object.label;
  return {};
}

std::string speedChart(const ReportedRun& reported, std::int64_t track) {
  const RecordedDrive& drive = reported.drive;
  const auto time_s = [&](std::int64_t frame) { return secondsBetween(drive.stamps.front(), drive.stamps[frame]); };
  ChartLine speed{.name = "estimate, 2 sigma", .color = colorOf(track)};
  LineOverFrames estimates(speed);
  for (const auto& [frame, objects] : drive.objects) {
    for (const ObjectEstimate& object : objects) {
      if (object.track.value != track || std::cmp_greater_equal(frame, drive.stamps.size())) continue;
      estimates.add(frame, {time_s(frame), object.velocity_world_mps.norm()}, 2 * object.speed_sigma_mps);
    }
  }
  std::vector<ChartLine> lines{std::move(speed)};
  std::string caption = fmt::format("Object {}", track);
  if (const auto label = labelOf(reported, track)) {
    ChartLine truth{.name = "truth", .color = "var(--truth)", .dashed = true};
    LineOverFrames speeds(truth);
    for (const auto& [frame, speed_mps] : trueSpeeds_mps(drive, *label)) speeds.add(frame, {time_s(frame), speed_mps});
    lines.push_back(std::move(truth));
    caption += fmt::format(", label {}", *label);
  }
  return chartFigure(lineChart({.x = "s", .y = "speed, m/s"}, lines), caption);
}

/// The tracks with the most rows, in the order of their ids.
std::vector<std::int64_t> longestTracks(const RecordedDrive& drive) {
  std::vector<std::pair<std::size_t, std::int64_t>> by_length;
  for (const auto& [track, rows] : rowsByTrack(drive))
    if (rows.size() >= kLeastRows) by_length.emplace_back(rows.size(), track);
  std::ranges::sort(by_length, std::greater());
  if (by_length.size() > kMostSpeedCharts) by_length.resize(kMostSpeedCharts);
  std::vector<std::int64_t> tracks;
  for (const auto& [length, track] : by_length) tracks.push_back(track);
  std::ranges::sort(tracks);
  return tracks;
}

constexpr std::size_t kPictures = 4;
constexpr int kQuality = 78;  // of JPEG

/// The frame with the most objects in each quarter of the drive, the earliest of equals.
std::vector<std::size_t> chosenFrames(const RecordedDrive& drive) {
  const std::size_t frames = drive.T_world_cam.size();
  std::set<std::size_t> chosen;
  for (std::size_t part = 0; part < kPictures; ++part) {
    const std::size_t begin = frames * part / kPictures, end = frames * (part + 1) / kPictures;
    if (begin == end) continue;
    std::size_t best = (begin + end) / 2;
    for (std::size_t frame = begin; frame < end; ++frame)
      if (drive.objectsAt(frame).size() > drive.objectsAt(best).size()) best = frame;
    chosen.insert(best);
  }
  return {chosen.begin(), chosen.end()};
}

}  // namespace

std::string driveSection(const ReportedRun& reported) {
  if (reported.drive.T_world_cam.empty()) return "";
  std::string text = "<h2>The drive</h2>\n" + driveMap(reported);
  const auto tracks = longestTracks(reported.drive);
  if (tracks.empty()) return text;
  text += "<h2>Speeds of the objects</h2>\n<div class=\"grid\">\n";
  for (const std::int64_t track : tracks) text += speedChart(reported, track);
  return text + "</div>\n";
}

std::string pictureSection(const ReportedRun& reported) {
  if (!reported.sequence) return "";
  const RecordedDrive& drive = reported.drive;
  PairReader reader(*reported.sequence);
  std::string text;
  for (const std::size_t frame : chosenFrames(drive)) {
    try {
      const auto number = static_cast<std::size_t>(drive.first_frame) + frame;
      const DrawnImages images = readDrawnImages(*reported.sequence, number, reported.run.folder, reader);
      const std::string jpeg = encodeJpeg(drawFrame(images, drive, frame), kQuality);
      text += fmt::format("<figure><img alt=\"frame {}\" src=\"{}\"></figure>\n", number, dataUri("image/jpeg", jpeg));
    } catch (const InputError& problem) {
      text += "<p class=\"muted\">" + escaped(problem.what()) + "</p>\n";
    }
  }
  return text.empty() ? "" : "<h2>As the camera saw it</h2>\n" + text;
}

}  // namespace motorcade
