#include <cassert>
#include <string>

#include <Eigen/Geometry>

#include "io/files/errors.hpp"
#include "io/sequence/timestamps.hpp"
#include "io/truth/ground_truth.hpp"

namespace motorcade {
namespace {

/// The packet's velocity along east, north and up. KITTI's packets give it along axes that only turn with the yaw (vf
/// and vl are parallel to the earth's surface), not with pitch and roll.
Eigen::Vector3d velocityOf(const OxtsPacket& packet) {
  return Eigen::AngleAxisd(packet.yaw_rad, Eigen::Vector3d::UnitZ()) * *packet.velocity_mps;
}

}  // namespace

std::vector<SE3> velocityPoses(const std::vector<OxtsPacket>& packets, const std::vector<Timestamp>& stamps,
                               const std::filesystem::path& file) {
  assert(stamps.size() == packets.size());
  std::vector<SE3> poses;
  Eigen::Vector3d place_m = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < packets.size(); ++i) {
    if (!packets[i].velocity_mps)
      throw InputError(file.string() + ": packet " + std::to_string(i) +
                       " has no velocity; fields 9 to 11 of each, vf vl vu, are needed for a path from velocities");
    if (i > 0)
      place_m += secondsBetween(stamps[i - 1], stamps[i]) * (velocityOf(packets[i - 1]) + velocityOf(packets[i])) / 2;
    poses.emplace_back(packets[i].attitude(), place_m);
  }
  return poses;
}

std::vector<Timestamp> packetStamps(const Sequence& sequence, std::size_t packets) {
  const auto& file = sequence.truth.oxts_timestamps;
  std::vector<Timestamp> stamps;
  if (!file.empty())
    stamps = readTimestamps(file);
  else if (sequence.stamps_measured)
    stamps = sequence.stamps;
  if (stamps.size() == packets) return stamps;
  const std::string whose = sequence.truth.oxts.string() + ": has " + std::to_string(packets) + " packets, ";
  if (stamps.empty())
    throw InputError(whose + "whose times are not known: lay oxts_timestamps.txt (of the raw recording, " +
                     "oxts/timestamps.txt) or times.txt beside the images");
  throw InputError(whose + "and " + (file.empty() ? "the images have" : file.string() + " has") + " " +
                   std::to_string(stamps.size()) + " times; a path from velocities needs one for each packet");
}

}  // namespace motorcade
