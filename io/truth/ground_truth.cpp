#include "io/truth/ground_truth.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include "io/files/errors.hpp"
#include "io/files/file_names.hpp"
#include "io/files/text_file.hpp"
#include "io/sequence/frame_lines.hpp"
#include "io/sequence/pose_interpolation.hpp"
#include "io/sequence/timestamps.hpp"
#include "io/truth/stamped_poses.hpp"
#include "io/truth/trajectory.hpp"
#include "io/truth/virtual_kitti.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

/// The fields after the attitude: the velocity to the north and to the east, then ahead, to the left and up.
std::optional<Eigen::Vector3d> readVelocity(FieldReader& fields) {
  FieldReader ahead = fields;
  for (int i = 0; i < 5; ++i) {
    if (ahead.atEnd()) return std::nullopt;
    ahead.word("velocity");
  }
  for (int i = 0; i < 2; ++i) fields.number("velocity");
  Eigen::Vector3d velocity_mps;
  for (double& along : velocity_mps) along = fields.number("velocity");
  return velocity_mps;
}

/// The turn rate after the velocity; empty where the packet ends before.
std::optional<double> readYawRate(FieldReader& fields) {
  constexpr int kAccelerationsAndRates = 11;  // ax ay az af al au wx wy wz wf wl, before wu
  for (int skipped = 0; skipped < kAccelerationsAndRates; ++skipped) {
    if (fields.atEnd()) return std::nullopt;
    fields.word("an acceleration or a turn rate");
  }
  if (fields.atEnd()) return std::nullopt;
  return fields.number("the turn rate about the upward axis");
}

OxtsPacket packetOf(const fs::path& file, const TextLine& line) {
  FieldReader fields(file, line);
  OxtsPacket packet;
  packet.latitude_deg = fields.number("latitude");
  packet.longitude_deg = fields.number("longitude");
  packet.altitude_m = fields.number("altitude");
  packet.roll_rad = fields.number("roll");
  packet.pitch_rad = fields.number("pitch");
  packet.yaw_rad = fields.number("yaw");
  packet.velocity_mps = readVelocity(fields);
  packet.yaw_rate_radps = readYawRate(fields);
  constexpr double kMaxMercator_deg = 89;
  if (std::abs(packet.latitude_deg) > kMaxMercator_deg) fields.fail("the latitude is out of range");
  return packet;
}

/// Poses of the inertial unit on a Mercator plane whose scale is true at the first packet
/// (Geiger et al., Vision meets Robotics: the KITTI Dataset, 2013, section III).
std::vector<SE3> mercatorPoses(const std::vector<OxtsPacket>& packets) {
  constexpr double kEarthRadius_m = 6378137, kRadPerDeg = std::numbers::pi / 180;
  std::vector<SE3> poses;
  const double scale_m = kEarthRadius_m * (packets.empty() ? 1.0 : std::cos(packets.front().latitude_deg * kRadPerDeg));
  for (const auto& p : packets) {
    const Eigen::Vector3d position_m{scale_m * p.longitude_deg * kRadPerDeg,
                                     scale_m * std::log(std::tan((90 + p.latitude_deg) * kRadPerDeg / 2)),
                                     p.altitude_m};
    poses.emplace_back(p.attitude(), position_m);
  }
  return poses;
}

std::vector<SE3> interpolated(const std::vector<SE3>& poses, const Sequence::Truth& truth) {
  const auto packet_stamps = readTimestamps(truth.oxts_timestamps),
             image_stamps = readTimestamps(truth.image_timestamps);
  if (packet_stamps.size() != poses.size()) {
    throw InputError(truth.oxts_timestamps.string() + ": has " + std::to_string(packet_stamps.size()) + " times for " +
                     std::to_string(poses.size()) + " packets");
  }
  std::vector<SE3> result;
  result.reserve(image_stamps.size());
  for (const Timestamp stamp : image_stamps) result.push_back(poseAt(stamp, poses, packet_stamps));
  return result;
}

/// Computes T_world_cam = C B P_0^-1 P_k B^-1 C^-1. B takes the inertial unit to the left gray camera, C takes that
/// camera to the pair's left one.
std::optional<CameraTruth> truthFromOxts(const Sequence& sequence, OxtsTimes times) {
  const auto T_cam0_imu = sequence.calibration.T_cam0_imu();
  if (sequence.truth.oxts.empty() || !T_cam0_imu) return std::nullopt;
  const auto packets = readOxts(sequence.truth.oxts);
  const bool by_velocity = times == OxtsTimes::kVelocities;
  std::vector<SE3> poses = by_velocity
                               ? velocityPoses(packets, packetStamps(sequence, packets.size()), sequence.truth.oxts)
                               : mercatorPoses(packets);
  const bool both_times = !sequence.truth.oxts_timestamps.empty() && !sequence.truth.image_timestamps.empty();
  const bool interpolate = times != OxtsTimes::kUninterpolated && both_times && poses.size() >= 2;
  if (interpolate) poses = interpolated(poses, sequence.truth);
  if (!poses.empty() && linesBelongToNumbers(sequence, poses.size()))
    poses = posesOfFrames(sequence, poses, sequence.truth.oxts);
  if (poses.size() < sequence.frames.size()) {
    throw InputError(sequence.truth.oxts.string() + ": tells of " + std::to_string(poses.size()) +
                     " frames, there are " + std::to_string(sequence.frames.size()) + " images");
  }
  CameraTruth truth{.T_world_cam = {},
                    .source = sequence.truth.oxts.filename().string() + (by_velocity ? ", velocities" : "") +
                              (interpolate ? " (interpolated)" : " (uninterpolated)")};
  const SE3 T_cam_imu = sequence.calibration.T_left_cam0(sequence.pair) * *T_cam0_imu;
  const SE3 T_world_mercator = T_cam_imu * poses.front().inverse();
  const SE3 T_imu_cam = T_cam_imu.inverse();
  for (std::size_t i = 0; i < sequence.frames.size(); ++i)
    truth.T_world_cam.push_back(T_world_mercator * poses[i] * T_imu_cam);
  return truth;
}

/// Interpolates known poses at the frames between the first and the last of them, in the world of the first such frame.
CameraTruth truthAtFrames(const Sequence& sequence, const StampedPoses& known, const fs::path& file,
                          const SE3& T_posed_cam) {
  CameraTruth truth{.T_world_cam = {}, .source = file.filename().string()};
  const auto& stamps = sequence.stamps;
  if (known.stamps.size() < 2 || known.stamps.front() > stamps.back() || known.stamps.back() < stamps.front())
    throw InputError(file.string() + ": has no poses of the time of the images");
  const auto first = std::ranges::lower_bound(stamps, known.stamps.front()) - stamps.begin();
  const auto end = std::ranges::upper_bound(stamps, known.stamps.back()) - stamps.begin();
  if (end - first < 2 && stamps.size() > 1)
    throw InputError(file.string() + ": tells of the time of " + std::to_string(end - first) + " of " +
                     std::to_string(stamps.size()) + " images; more poses are needed");
  truth.first_frame = first;
  const auto poseOf = [&](std::ptrdiff_t frame) {
    return poseAt(stamps[std::max(frame, first)], known.poses, known.stamps) * T_posed_cam;
  };
  const SE3 T_world_reference = poseOf(first).inverse();
  for (std::ptrdiff_t frame = 0; frame < end; ++frame) truth.T_world_cam.push_back(T_world_reference * poseOf(frame));
  return truth;
}

CameraTruth truthFromPoses(const Sequence& sequence) {
  const SE3 T_left_cam0 = sequence.calibration.T_left_cam0(sequence.pair);
  if (const auto known = readTimedPoses(sequence.truth.poses, sequence))
    return truthAtFrames(sequence, *known, sequence.truth.poses, T_left_cam0.inverse());
  CameraTruth truth{.T_world_cam = readKittiPoses(sequence.truth.poses),
                    .source = sequence.truth.poses.filename().string()};
  if (linesBelongToNumbers(sequence, truth.T_world_cam.size()))
    truth.T_world_cam = posesOfFrames(sequence, truth.T_world_cam, sequence.truth.poses);
  if (truth.T_world_cam.size() < sequence.frames.size()) {
    throw InputError(sequence.truth.poses.string() + ": has " + std::to_string(truth.T_world_cam.size()) +
                     " poses for " + std::to_string(sequence.frames.size()) + " images; one line for each is needed");
  }
  for (auto& pose : truth.T_world_cam) pose = T_left_cam0 * pose * T_left_cam0.inverse();
  return truth;
}

/// Camera truth from poses whose stamps differ from those of the images.
std::optional<CameraTruth> truthFromStampedPoses(const Sequence& sequence) {
  const bool numbered = sequence.truth.stamped_poses.empty();
  const fs::path& file = numbered ? sequence.truth.numbered_poses : sequence.truth.stamped_poses;
  if (file.empty()) return std::nullopt;
  const StampedPoses known = numbered ? readNumberedPoses(file, sequence) : readStampedPoses(file);
  return truthAtFrames(sequence, known, file, sequence.truth.T_posed_cam);
}

SE3 boxPose(const Label& label) {
  return {Eigen::AngleAxisd(label.rotation_y_rad, Eigen::Vector3d::UnitY()).toRotationMatrix(), label.location_m};
}

using PoseByFrameAndId = std::map<std::pair<std::int64_t, std::int64_t>, SE3>;

/// Rendered sequences give poses of objects with x ahead, y left, z up, in the world of the left gray camera; a box
/// frame has y down and z left.
PoseByFrameAndId readObjectPoses(const fs::path& file) {
  PoseByFrameAndId poses;
  if (file.empty()) return poses;
  Eigen::Matrix3d object_box;
  object_box << 1, 0, 0, 0, 0, 1, 0, -1, 0;  // its columns are the axes of the box frame
  for (const auto& line : readLines(file)) {
    FieldReader fields(file, line);
    const std::int64_t frame = fields.integer("frame"), id = fields.integer("id");
    fields.integer("moving");
    const SE3 T_world_object = fields.pose("T_world_object");
    fields.expectEnd();
    poses[{frame, id}] = T_world_object * SE3(object_box, Eigen::Vector3d::Zero());
  }
  return poses;
}

/// Labels with the numbers of the sequence's frames. The file counts the lines of the poses, where these exist, else
/// the complete numbering of the images.
std::vector<Label> labelsOfFrames(const Sequence& sequence) {
  std::vector<Label> labels = readLabels(sequence.truth.labels);
  if (sequence.frames.empty()) return labels;
  std::size_t lines = static_cast<std::size_t>(placeOf(sequence, sequence.frames.size() - 1)) + 1;
  if (!sequence.truth.poses.empty() && !readTimedPoses(sequence.truth.poses, sequence))
    lines = readKittiPoses(sequence.truth.poses).size();
  if (!linesBelongToNumbers(sequence, lines)) return labels;
  const FramesOfLines frames = framesOfLines(sequence, lines, sequence.truth.labels, "numbers");
  std::erase_if(labels, [&](Label& label) {
    const auto line = static_cast<std::size_t>(label.frame.value);
    label.frame.value = line < frames.size() ? frames[line] : -1;
    return label.frame.value < 0;
  });
  return labels;
}

}  // namespace

Eigen::Matrix3d OxtsPacket::attitude() const {
  using Eigen::AngleAxisd, Eigen::Vector3d;
  const Eigen::Quaterniond turn = AngleAxisd(yaw_rad, Vector3d::UnitZ()) * AngleAxisd(pitch_rad, Vector3d::UnitY()) *
                                  AngleAxisd(roll_rad, Vector3d::UnitX());
  return turn.toRotationMatrix();
}

std::vector<OxtsPacket> readOxts(const fs::path& file_or_folder) {
  std::vector<OxtsPacket> packets;
  if (!fs::is_directory(file_or_folder)) {
    for (const auto& line : readLines(file_or_folder)) packets.push_back(packetOf(file_or_folder, line));
    return packets;
  }
  std::vector<fs::path> files = listFolder(file_or_folder);
  std::erase_if(files, [](const fs::path& file) { return file.extension() != ".txt"; });
  for (const auto& file : files) {
    const auto lines = readLines(file);
    if (lines.empty()) throw InputError(file.string() + ": is empty, a packet is expected");
    packets.push_back(packetOf(file, lines.front()));
  }
  return packets;
}

std::optional<CameraTruth> readCameraTruth(const Sequence& sequence, OxtsTimes times) {
  if (times == OxtsTimes::kVelocities) return truthFromOxts(sequence, times);
  if (times == OxtsTimes::kUninterpolated) {
    if (auto truth = truthFromOxts(sequence, times)) return truth;
  }
  if (!sequence.truth.virtual_kitti.empty()) return virtualKittiCamera(sequence);
  if (!sequence.truth.poses.empty()) return truthFromPoses(sequence);
  if (auto truth = truthFromStampedPoses(sequence)) return truth;
  return truthFromOxts(sequence, times);
}

std::optional<ObjectTruths> readObjectTruths(const Sequence& sequence, const CameraTruth& camera) {
  if (!sequence.truth.virtual_kitti.empty()) return virtualKittiObjects(sequence, camera);
  if (sequence.truth.labels.empty()) return std::nullopt;
  const auto exact = readObjectPoses(sequence.truth.object_poses);
  ObjectTruths truths;
  truths.source = sequence.truth.labels.filename().string();
  if (!exact.empty()) truths.source.append(" with ").append(sequence.truth.object_poses.filename().string());
  const SE3 T_left_cam0 = sequence.calibration.T_left_cam0(sequence.pair);
  for (const auto& label : labelsOfFrames(sequence)) {
    if (label.dontCare()) {
      truths.ignored.push_back({label.frame, label.box});
      continue;
    }
    const std::size_t frame = label.frame.value;
    if (frame >= camera.T_world_cam.size()) continue;
    ObjectTruth truth;
    truth.frame = label.frame;
    truth.id = label.track;
    truth.type = label.type;
    truth.T_cam_object = T_left_cam0 * boxPose(label);
    truth.T_world_object = camera.T_world_cam[frame] * truth.T_cam_object;
    if (const auto found = exact.find({label.frame.value, label.track}); found != exact.end()) {
      truth.T_world_object = T_left_cam0 * found->second;
      truth.T_cam_object = camera.T_world_cam[frame].inverse() * truth.T_world_object;
    }
    truth.box = label.box;
    truth.size_m = label.size_m;
    truth.truncated = label.truncated;
    truth.occluded = label.occluded;
    truths.objects.push_back(std::move(truth));
  }
  std::ranges::sort(truths.objects, {}, [](const ObjectTruth& t) { return std::pair(t.frame, t.id); });
  return truths;
}

}  // namespace motorcade
