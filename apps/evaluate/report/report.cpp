#include "apps/evaluate/report/report.hpp"

#include <algorithm>
#include <cmath>
#include <iostream>

#include <nlohmann/json.hpp>

#include "apps/evaluate/comparison/object_matching.hpp"
#include "apps/recorded/recorded_run.hpp"
#include "io/files/file_descriptor.hpp"
#include "io/files/line_file.hpp"
#include "io/truth/labels.hpp"

namespace motorcade {

nlohmann::ordered_json jsonOf(const Reliability& reliability, const char* hits) {
  using Json = nlohmann::ordered_json;
  Json tenths = Json::array();
  for (const ReliabilityTenth& tenth : reliability.tenths)
    tenths.push_back({{"rows", tenth.rows}, {hits, tenth.hits}, {"probability_sum", tenth.probability_sum}});
  const auto gap = reliability.largestGap();
  return {{"rows", reliability.rows()},
          {"brier", reliability.rows() > 0 ? Json(reliability.brier()) : Json()},
          {"largest_gap", gap ? Json(*gap) : Json()},
          {"tenths", std::move(tenths)}};
}

namespace {

namespace fs = std::filesystem;

std::string kittiType(ObjectKind kind) {
  switch (kind) {
    case ObjectKind::kCar:
      return "Car";
    case ObjectKind::kLargeVehicle:
      return "Truck";
    case ObjectKind::kTwoWheeler:
      return "Cyclist";
    case ObjectKind::kPedestrian:
      return "Pedestrian";
    case ObjectKind::kUnknown:
      break;
  }
  return "Misc";
}

/// KITTI ranks results by their score and defines no scale. Our score is the object's existence probability, times a
/// share that grows with the number of its points. The share is one half at kHalfSure_points, and a third in a row with
/// the fewest points that are reported.
double scoreOf(const ObjectEstimate& object) {
  constexpr double kHalfSure_points = 6;
  return object.existence_probability * object.points / (object.points + kHalfSure_points);
}

/// The part of a box that lies in the image.
Box inImage(const Box& box, const StereoCamera& camera) {
  const double right_px = camera.width_px - 1.0, bottom_px = camera.height_px - 1.0;
  return {std::clamp(box.left_px, 0.0, right_px), std::clamp(box.top_px, 0.0, bottom_px),
          std::clamp(box.right_px, 0.0, right_px), std::clamp(box.bottom_px, 0.0, bottom_px)};
}

/// Converts a row with a cuboid to a label. `T_cam0_world` leads to the left gray camera, the frame of labels.
Label labelOf(const RunFolder::ObjectRow& row, const SE3& T_cam0_world, const StereoCamera& camera) {
  const ObjectBox& cuboid = *row.object.cuboid;
  const SE3 T_cam0_body = T_cam0_world * row.object.T_world_body;
  const Eigen::Vector3d to_bottom_m(0, 0, -0.5 * cuboid.size_m.z()), ahead = T_cam0_body.rotation().col(0);
  return {.frame = row.frame,
          .track = row.object.track.value,
          .type = kittiType(cuboid.kind),
          .box = inImage(row.object.box, camera),
          .size_m = cuboid.size_m.reverse(),
          .location_m = T_cam0_body * (cuboid.center_body + to_bottom_m),
          .rotation_y_rad = std::atan2(-ahead.z(), ahead.x())};
}

void exportKind(const fs::path& folder, const RunFolder::Trajectories& trajectories, std::int64_t first_frame,
                const Sequence& sequence) {
  makeFolder(folder);
  const SE3 T_cam0_cam = sequence.calibration.T_left_cam0(sequence.pair).inverse();
  LineFile out(folder / (sequence.folder.filename().string() + ".txt"));
  for (const auto& row : trajectories.objects) {
    const std::int64_t index = row.frame.value - first_frame;
    const bool has_pose = index >= 0 && index < std::ssize(trajectories.camera);
    if (!has_pose || !row.object.cuboid || !isReported(row.object)) continue;
    const SE3 T_cam0_world = T_cam0_cam * trajectories.camera[index].inverse();
    out.writeLine(resultLine(labelOf(row, T_cam0_world, sequence.camera), scoreOf(row.object)));
  }
  out.close();
}

/// Exports results where asked. Returns true if that is all, as there is no truth to measure by.
bool exportAlone(const EvaluateOptions& options) {
  if (options.export_kitti.empty()) return false;
  RunFolder run = readRunFolder(options.run);
  const Sequence sequence = openSequenceOf(run, {options.sequence, options.fps_hz});
  recoverFinals(run);
  exportKitti(options.export_kitti, run, sequence);
  return options.json.empty() && !readCameraTruth(sequence);
}

}  // namespace

void exportKitti(const fs::path& folder, const RunFolder& run, const Sequence& sequence) {
  exportKind(folder / "final" / "data", run.final, run.first_frame, sequence);
  exportKind(folder / "online" / "data", run.online, run.first_frame, sequence);
}

int runEvaluate(const EvaluateOptions& options) {
  if (exportAlone(options)) {
    std::cout << "results in " << options.export_kitti.string()
              << "; nothing is measured, as the sequence has no ground truth\n";
    return 0;
  }
  const Evaluation evaluation = evaluateRun(options);
  std::cout << tableOf(evaluation);
  if (!options.json.empty()) writeAtOnce(options.json, jsonOf(evaluation));
  return 0;
}

}  // namespace motorcade
