#include "apps/export/exported_frame.hpp"

#include <algorithm>

#include "io/images/image_file.hpp"

namespace motorcade {
namespace {

constexpr int kQuality = 90;

void addPoint(std::vector<ExportedFrame::Point>& points, TrackId track, const Eigen::Vector3d& uvd_px,
              const StereoCamera& camera) {
  if (uvd_px.z() > 0) points.push_back({track, camera.triangulate(uvd_px)});
}

/// The row of a frame; rows are in the order of frames, and a killed run may lack the last ones.
const FrameRow* rowOf(const RunFolder& run, FrameId frame) {
  const auto row = std::ranges::lower_bound(run.frames, frame, {}, [](const FrameRow& r) { return r.head.frame; });
  return row != run.frames.end() && row->head.frame == frame ? &*row : nullptr;
}

}  // namespace

std::vector<ExportedFrame::Point> exportedPoints(const FrameMeasurements& measurements, const StereoCamera& camera) {
  std::vector<ExportedFrame::Point> points;
  for (const PointMeasurement& point : measurements.at_rest) addPoint(points, {}, point.uvd_px.cast<double>(), camera);
  for (const ObjectObservation& seen : measurements.objects) {
    if (seen.frame != measurements.head.frame) continue;  // from before it was confirmed
    for (const PointMeasurement& point : seen.measured)
      addPoint(points, seen.track, point.uvd_px.cast<double>(), camera);
  }
  return points;
}

ExportedFrame::StageTimes stageTimes(const FrameTiming& timing) {
  ExportedFrame::StageTimes times;
  for (std::size_t i = 0; i < kStageCount; ++i) {
    const auto stage = static_cast<Stage>(i);
    times[i] = {timing.of(stage).duration_ms(), timing.wait_ms(stage), timing.of(stage).cpu_ms};
  }
  return times;
}

ExportedFrame exportedFrame(const RecordedDrive& drive, const RunFolder& run, std::size_t index) {
  ExportedFrame frame;
  frame.estimate.head = {.frame = {drive.first_frame + static_cast<std::int64_t>(index)}, .stamp = drive.stamps[index]};
  frame.estimate.T_world_cam = drive.T_world_cam[index];
  frame.estimate.objects = drive.objectsAt(index);
  if (const FrameRow* const row = rowOf(run, frame.estimate.head.frame)) {
    frame.estimate.head = row->head;
    frame.latency_ms = row->latency_ms;
    frame.decode_ms = row->decode_ms;
    frame.stages = row->stages;
  }
  for (const ObjectPoint& point : drive.pointsAt(index))
    addPoint(frame.points, point.track, point.uvd_px, drive.camera);
  return frame;
}

std::string exportedImage(const Image& left) { return encodeJpeg(left, kQuality); }

}  // namespace motorcade
