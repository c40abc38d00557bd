#include "io/truth/virtual_kitti.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"
#include "io/sequence/image_names.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kLeftCamera = 0, kRightCamera = 1;  // cameraID

/// The lines of a table behind its header, which begins with `first_column`.
std::vector<TextLine> tableLines(const fs::path& file, std::string_view first_column) {
  auto lines = readLines(file);
  if (lines.empty() || !lines.front().text.starts_with(first_column))
    throw InputError(file.string() + ": is no table of Virtual KITTI 2; its first line must begin with " +
                     std::string(first_column));
  lines.erase(lines.begin());
  return lines;
}

struct Extrinsics {
  std::map<std::int64_t, SE3> T_left_map, T_right_map;  // by the frame's number
};

Extrinsics readExtrinsics(const fs::path& tables) {
  const fs::path file = tables / "extrinsic.txt";
  Extrinsics extrinsics;
  for (const TextLine& line : tableLines(file, "frame")) {
    FieldReader fields(file, line);
    const std::int64_t frame = fields.integer("frame"), camera = fields.integer("cameraID");
    const SE3 T_cam_map = fields.pose("a pose from the world to the camera");
    for (const double expected : {0, 0, 0, 1})
      if (fields.number("the last row") != expected) fields.fail("the last row of the matrix must be 0 0 0 1");
    if (camera == kLeftCamera) extrinsics.T_left_map[frame] = T_cam_map;
    if (camera == kRightCamera) extrinsics.T_right_map[frame] = T_cam_map;
  }
  if (extrinsics.T_left_map.empty()) throw InputError(file.string() + ": has no line of camera 0");
  return extrinsics;
}

/// The mean over all frames, as each is the difference of two rounded numbers.
double baselineOf(const Extrinsics& extrinsics, const fs::path& file) {
  constexpr double kStated_m = 0.532725, kRounding_m = 1e-3, kLevel = 0.01;
  Eigen::Vector3d sum_m = Eigen::Vector3d::Zero();
  int frames = 0;
  for (const auto& [frame, T_left_map] : extrinsics.T_left_map) {
    const auto right = extrinsics.T_right_map.find(frame);
    if (right == extrinsics.T_right_map.end()) continue;
    const SE3 T_left_right = T_left_map * right->second.inverse();
    if (logSO3(T_left_right.rotation()).norm() > kLevel)
      throw InputError(file.string() + ": the cameras of frame " + std::to_string(frame) +
                       " look into different directions; a rectified pair is needed");
    sum_m += T_left_right.translation();
    ++frames;
  }
  if (frames == 0) return kStated_m;
  const Eigen::Vector3d right_m = sum_m / frames;
  if (!(right_m.x() > 0) || right_m.tail<2>().norm() > kLevel * right_m.x() + kRounding_m)
    throw InputError(file.string() + ": camera 1 is not to the right of camera 0");
  return std::abs(right_m.x() - kStated_m) < kRounding_m ? kStated_m : right_m.x();
}

/// The camera frames: x right, y down, z ahead. The angles turn about z, then x, then y, as Unity's do; `y` is KITTI's
/// rotation_y.
Eigen::Matrix3d attitude(double y_rad, double x_rad, double z_rad) {
  using Eigen::AngleAxisd, Eigen::Vector3d;
  return (AngleAxisd(y_rad, Vector3d::UnitY()) * AngleAxisd(x_rad, Vector3d::UnitX()) *
          AngleAxisd(z_rad, Vector3d::UnitZ()))
      .toRotationMatrix();
}

using FrameAndTrack = std::pair<std::int64_t, std::int64_t>;

/// A row of bbox.txt.
struct SeenBox {
  Box box;
  double pixels = 0;
  double truncated = 0;
};

std::map<FrameAndTrack, SeenBox> readBoxes(const fs::path& file) {
  std::map<FrameAndTrack, SeenBox> boxes;
  for (const TextLine& line : tableLines(file, "frame")) {
    FieldReader fields(file, line);
    const std::int64_t frame = fields.integer("frame"), camera = fields.integer("cameraID"),
                       track = fields.integer("trackID");
    SeenBox seen;
    for (double* edge_px : {&seen.box.left_px, &seen.box.right_px, &seen.box.top_px, &seen.box.bottom_px})
      *edge_px = fields.number("an edge of the box");
    seen.pixels = fields.number("number_pixels");
    seen.truncated = fields.number("truncation_ratio");
    if (camera == kLeftCamera) boxes[{frame, track}] = seen;
  }
  return boxes;
}

std::map<std::int64_t, std::string> readTypes(const fs::path& file) {
  std::map<std::int64_t, std::string> types;
  if (!fs::exists(file)) return types;
  for (const TextLine& line : tableLines(file, "trackID")) {
    FieldReader fields(file, line);
    const std::int64_t track = fields.integer("trackID");
    types[track] = fields.word("label");
  }
  return types;
}

/// The area that a cuboid covers in the image plane. Each ray that meets it passes two of its faces.
std::optional<double> projectedArea_px2(const ObjectTruth& object, const StereoCamera& camera) {
  constexpr double kNear_m = 0.2;
  std::array<Eigen::Vector2d, 8> corners;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d p_object((i & 1U ? 0.5 : -0.5) * object.size_m[2], i & 2U ? -object.size_m[0] : 0.0,
                                   (i & 4U ? 0.5 : -0.5) * object.size_m[1]);
    const Eigen::Vector3d p_cam = object.T_cam_object * p_object;
    if (p_cam.z() < kNear_m) return std::nullopt;
    corners[i] = {camera.fx_px * p_cam.x() / p_cam.z(), camera.fy_px * p_cam.y() / p_cam.z()};
  }
  constexpr std::array<std::array<std::size_t, 4>, 6> kFaces = {
      {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}};
  double twice_px2 = 0;
  for (const auto& face : kFaces) {
    const Eigen::Vector2d first = corners[face[2]] - corners[face[0]], second = corners[face[3]] - corners[face[1]];
    twice_px2 += std::abs(first.x() * second.y() - first.y() * second.x()) / 2;
  }
  return twice_px2 / 2;
}

/// KITTI's levels from the visible share of the object's pixels. The table's occupancy_ratio does not measure that: it
/// is the share of the box that its pixels fill, .55 to .85 for a free car. At the image's edge, where a cuboid's
/// projection is unbounded, the box is used instead.
int occlusionOf(const ObjectTruth& object, const SeenBox& seen, const StereoCamera& camera) {
  constexpr double kVehicleInCuboid = 0.75;  // how much of a cuboid's projection a vehicle covers
  constexpr double kAtEdge = 0.25, kVisible = 0.8, kPartly = 0.4;
  constexpr int kHidden = 2;
  const double box_px2 = (seen.box.right_px - seen.box.left_px) * (seen.box.bottom_px - seen.box.top_px);
  if (!(seen.pixels > 0) || !(box_px2 > 0)) return kHidden;
  const auto area_px2 = projectedArea_px2(object, camera);
  const bool at_edge = seen.truncated > kAtEdge || !area_px2;
  const double expected_px2 = kVehicleInCuboid * (at_edge ? box_px2 : (1 - seen.truncated) * *area_px2);
  const double visible = seen.pixels / expected_px2;
  return visible >= kVisible ? 0 : visible >= kPartly ? 1 : kHidden;
}

void describeView(ObjectTruth& object, const SeenBox& seen, const StereoCamera& camera) {
  object.box = seen.box;
  object.truncated = seen.truncated;
  object.occluded = occlusionOf(object, seen, camera);
}

/// The number of each image, by which the tables name a frame.
std::vector<std::int64_t> frameNumbers(const Sequence& sequence) {
  std::vector<std::int64_t> numbers;
  for (const FramePaths& frame : sequence.frames) numbers.push_back(imageNumber(frame.left).value_or(-1));
  return numbers;
}

/// A row of pose.txt.
struct PosedObject {
  std::int64_t frame = 0, camera = 0;
  ObjectTruth truth;
};

PosedObject readPosedObject(FieldReader& fields) {
  PosedObject object;
  object.frame = fields.integer("frame");
  object.camera = fields.integer("cameraID");
  object.truth.id = fields.integer("trackID");
  fields.number("alpha");
  for (const int side : {1, 0, 2}) object.truth.size_m[side] = fields.number("width, height and length");
  for (int i = 0; i < 6; ++i) fields.number("the pose in the world");
  Eigen::Vector3d location_m;
  for (double& value : location_m) value = fields.number("the place in the camera's space");
  std::array<double, 3> angles_rad{};
  for (double& value : angles_rad) value = fields.number("a rotation in the camera's space");
  fields.expectEnd();
  object.truth.T_cam_object = SE3(attitude(angles_rad[0], angles_rad[1], angles_rad[2]), location_m);
  return object;
}

}  // namespace

StereoCamera readVirtualKittiCamera(const fs::path& tables) {
  const fs::path file = tables / "intrinsic.txt";
  std::optional<std::array<double, 4>> common;
  for (const TextLine& line : tableLines(file, "frame")) {
    FieldReader fields(file, line);
    fields.integer("frame");
    fields.integer("cameraID");
    std::array<double, 4> values{};
    for (double& value : values) value = fields.number("a focal length or a principal point");
    if (!common) common = values;
    if (*common != values) fields.fail("the camera is another than in the line before; a drive has one");
    if (!(values[0] > 0) || !(values[1] > 0)) fields.fail("the focal lengths must be positive");
  }
  if (!common) throw InputError(file.string() + ": has no line of a camera");
  const auto& [fx, fy, cx, cy] = *common;
  return {.fx_px = fx,
          .fy_px = fy,
          .cx_px = cx,
          .cy_px = cy,
          .baseline_m = baselineOf(readExtrinsics(tables), tables / "extrinsic.txt")};
}

std::map<std::int64_t, SE3> readVirtualKittiPoses(const fs::path& tables) {
  std::map<std::int64_t, SE3> poses;
  for (const auto& [frame, T_cam_map] : readExtrinsics(tables).T_left_map) poses[frame] = T_cam_map.inverse();
  return poses;
}

CameraTruth virtualKittiCamera(const Sequence& sequence) {
  const fs::path& tables = sequence.truth.virtual_kitti;
  const auto poses = readVirtualKittiPoses(tables);
  CameraTruth truth{.T_world_cam = {}, .source = "extrinsic.txt"};
  std::optional<SE3> T_world_map;
  for (const std::int64_t number : frameNumbers(sequence)) {
    const auto pose = poses.find(number);
    if (pose == poses.end())
      throw InputError((tables / "extrinsic.txt").string() + ": has no line of frame " + std::to_string(number) +
                       " and camera 0, of which there is an image");
    if (!T_world_map) T_world_map = pose->second.inverse();
    truth.T_world_cam.push_back(*T_world_map * pose->second);
  }
  return truth;
}

std::optional<ObjectTruths> virtualKittiObjects(const Sequence& sequence, const CameraTruth& camera) {
  const fs::path& tables = sequence.truth.virtual_kitti;
  const fs::path poses = tables / "pose.txt", boxes_file = tables / "bbox.txt";
  if (!fs::exists(poses) || !fs::exists(boxes_file)) return std::nullopt;
  const auto boxes = readBoxes(boxes_file);
  const auto types = readTypes(tables / "info.txt");
  std::map<std::int64_t, std::int64_t> frame_of;
  const auto numbers = frameNumbers(sequence);
  for (std::size_t i = 0; i < std::min(numbers.size(), camera.T_world_cam.size()); ++i)
    frame_of[numbers[i]] = static_cast<std::int64_t>(i);
  ObjectTruths truths{.objects = {}, .ignored = {}, .source = "pose.txt and bbox.txt"};
  for (const TextLine& line : tableLines(poses, "frame")) {
    FieldReader fields(poses, line);
    PosedObject object = readPosedObject(fields);
    const auto frame = frame_of.find(object.frame);
    if (object.camera != kLeftCamera || frame == frame_of.end()) continue;
    object.truth.frame = {frame->second};
    object.truth.T_world_object =
        camera.T_world_cam[static_cast<std::size_t>(frame->second)] * object.truth.T_cam_object;
    const auto type = types.find(object.truth.id);
    object.truth.type = type == types.end() ? "Car" : type->second;
    const auto seen = boxes.find({object.frame, object.truth.id});
    describeView(object.truth, seen == boxes.end() ? SeenBox{} : seen->second, sequence.camera);
    truths.objects.push_back(std::move(object.truth));
  }
  std::ranges::sort(truths.objects, {}, [](const ObjectTruth& t) { return std::pair(t.frame, t.id); });
  return truths;
}

}  // namespace motorcade
