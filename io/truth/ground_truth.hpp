#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/messages.hpp"
#include "core/timestamp.hpp"
#include "io/sequence/sequence.hpp"
#include "io/truth/labels.hpp"

/// The truth of a sequence, converted to our conventions: `world` is the first left camera of the images' pair.
namespace motorcade {

/// The rule by which oxts packets are assigned to images. The two are up to 5 ms apart.
enum class OxtsTimes {
  kInterpolated,    // packets interpolated at the images' times, where both time files are there
  kUninterpolated,  // packet k for image k, as published evaluations have it
  kVelocities,      // as kInterpolated, with the places that the packets' velocities lead to instead of their own
};

/// An inertial packet: the pose of the unit on a Mercator plane, x east, y north, z up.
struct OxtsPacket {
  double latitude_deg = 0, longitude_deg = 0, altitude_m = 0;
  double roll_rad = 0, pitch_rad = 0, yaw_rad = 0;
  std::optional<Eigen::Vector3d> velocity_mps;  // ahead and to the left, both level, and up; not in shortened packets
  std::optional<double> yaw_rate_radps{};       // about the upward axis; not in shortened packets
  Eigen::Matrix3d attitude() const;
};
std::vector<OxtsPacket> readOxts(const std::filesystem::path& file_or_folder);

struct CameraTruth {
  std::vector<SE3> T_world_cam;  // one per frame, but for those after the last that is known
  std::string source;            // for reports: which file, in what form
  std::int64_t first_frame = 0;  // that is known; those before it have the same pose
};
/// Reads the tables of Virtual KITTI, `poses.txt`, poses with times or numbers, or oxts: the first that is there.
/// `kUninterpolated` prefers oxts; `kVelocities` uses oxts alone. Empty when nothing is there.
std::optional<CameraTruth> readCameraTruth(const Sequence& sequence, OxtsTimes times = OxtsTimes::kInterpolated);

/// A labeled object in one frame.
struct ObjectTruth {
  FrameId frame;
  std::int64_t id = -1;
  std::string type;
  SE3 T_world_object;  // KITTI's box frame: origin at the center of the bottom face, x along the length, y down
  SE3 T_cam_object;    // the same from the frame's camera
  Box box;
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();  // height, width, length
  double truncated = 0;
  int occluded = 0;
};

/// Objects in the order of their frames and ids, and the areas that the labels leave open.
struct ObjectTruths {
  struct Ignored {
    FrameId frame;
    Box box;
  };
  std::vector<ObjectTruth> objects;
  std::vector<Ignored> ignored;
  std::string source;
};
/// Reads the tables of Virtual KITTI or the labels, with the poses of `object_poses.txt` where it has them. Empty when
/// neither is there.
std::optional<ObjectTruths> readObjectTruths(const Sequence& sequence, const CameraTruth& camera);

/// Poses of the inertial unit with the attitudes of its packets. The positions integrate the packets' velocities from
/// the first one by the trapezoidal rule. Throws InputError naming the packets' file where one has no velocity.
std::vector<SE3> velocityPoses(const std::vector<OxtsPacket>& packets, const std::vector<Timestamp>& stamps,
                               const std::filesystem::path& file);

/// Capture times of a sequence's packets, one for each: from their own file of times, else those of the images. Throws
/// InputError where neither is known or the number of times is not `packets`. An assumed rate would give a path of the
/// wrong length.
std::vector<Timestamp> packetStamps(const Sequence& sequence, std::size_t packets);

}  // namespace motorcade
