#include "io/truth/stamped_poses.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>

#include <Eigen/Geometry>

#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"
#include "io/sequence/image_names.hpp"
#include "io/truth/trajectory.hpp"

namespace motorcade {
namespace {

/// Appends a pose, which must be later than the one before.
void append(StampedPoses& known, Timestamp stamp, const SE3& pose, const FieldReader& fields) {
  if (!known.stamps.empty() && stamp <= known.stamps.back()) fields.fail("the pose is not later than the one before");
  known.stamps.push_back(stamp);
  known.poses.push_back(pose);
}

/// A place and a quaternion, as they stand in the file.
std::array<double, 7> readSeven(FieldReader& fields) {
  std::array<double, 7> values{};
  for (double& value : values) value = fields.number("a pose");
  return values;
}

SE3 poseOf(const Eigen::Vector3d& place_m, const Eigen::Quaterniond& q, const FieldReader& fields) {
  constexpr double kLength = 1e-2;  // by which a quaternion's may be off
  if (std::abs(q.norm() - 1) > kLength) fields.fail("the quaternion's length is not 1");
  return {q.normalized().toRotationMatrix(), place_m};
}

Timestamp stampOf(double time, const FieldReader& fields) {
  constexpr double kLeast_ns = 1e17, kMost_ns = 9e18, kMost_s = 4.5e9;  // nanoseconds of 1973 and later; 2112
  if (time >= kLeast_ns && time <= kMost_ns) return {std::llround(time)};
  if (std::abs(time) > kMost_s) fields.fail("the time is out of range; seconds or nanoseconds are expected");
  return {std::llround(time * 1e9)};
}

bool overlapInTime(const std::vector<Timestamp>& a, const std::vector<Timestamp>& b) {
  return !a.empty() && !b.empty() && a.front() <= b.back() && b.front() <= a.back();
}

/// True when there is a time for each image, and none is farther from its image's than that once both begin `offset_s`
/// apart.
bool fitImages(const std::vector<Timestamp>& times, const std::vector<Timestamp>& images, double offset_s,
               double most_s) {
  if (times.size() != images.size() || times.empty()) return false;
  for (std::size_t i = 0; i < times.size(); ++i)
    if (std::abs(secondsBetween(images[i], times[i]) - offset_s) > most_s) return false;
  return true;
}

/// True when two lists have the same moments: up to printed digits, or up to a constant and half an interval where they
/// have no time in common.
bool tellOfImages(const std::vector<Timestamp>& times, const std::vector<Timestamp>& images) {
  constexpr double kPrinted_s = 1e-3;
  if (overlapInTime(times, images)) return fitImages(times, images, 0, kPrinted_s);
  if (times.size() < 2 || images.empty()) return false;
  const double half_interval_s =
      secondsBetween(times.front(), times.back()) / static_cast<double>(times.size() - 1) / 2;
  return fitImages(times, images, secondsBetween(images.front(), times.front()), half_interval_s);
}

std::string spanText(const std::vector<Timestamp>& stamps) {
  const auto seconds = [](Timestamp stamp) { return std::to_string(secondsBetween(Timestamp{}, stamp)); };
  return stamps.empty() ? "no times" : seconds(stamps.front()) + " to " + seconds(stamps.back()) + " s";
}

StampedPoses onImageClock(StampedPoses known, const std::filesystem::path& file, const Sequence& sequence) {
  const bool one_each = known.stamps.size() == sequence.stamps.size();
  if (sequence.stamps_measured ? tellOfImages(known.stamps, sequence.stamps) : one_each) {
    known.stamps = sequence.stamps;
    return known;
  }
  if (sequence.stamps_measured && overlapInTime(known.stamps, sequence.stamps)) return known;
  const std::string what = file.string() + ": is a trajectory with " + std::to_string(known.stamps.size()) +
                           " poses at times of their own (" + spanText(known.stamps) + "), and the " +
                           std::to_string(sequence.stamps.size()) + " images ";
  if (!sequence.stamps_measured)
    throw InputError(what + "have no times; write theirs, on the same clock, into times.txt beside them, one a line");
  throw InputError(what + "were taken at others (" + spanText(sequence.stamps) + "); both must be of one clock");
}

}  // namespace

StampedPoses readStampedPoses(const std::filesystem::path& file) {
  StampedPoses known;
  for (const TextLine& line : readPoseLines(file)) {
    FieldReader fields(file, line, ',');
    const Timestamp stamp{fields.integer("a time in nanoseconds")};
    const auto v = readSeven(fields);
    append(known, stamp, poseOf({v[0], v[1], v[2]}, {v[3], v[4], v[5], v[6]}, fields), fields);
  }
  return known;
}

StampedPoses readTumPoses(const std::filesystem::path& file) {
  StampedPoses known;
  for (const TextLine& line : readPoseLines(file)) {
    FieldReader fields(file, line);
    const Timestamp stamp = stampOf(fields.number("a time in seconds"), fields);
    const auto v = readSeven(fields);
    append(known, stamp, poseOf({v[0], v[1], v[2]}, {v[6], v[3], v[4], v[5]}, fields), fields);
    fields.expectEnd();
  }
  return known;
}

StampedPoses readNumberedPoses(const std::filesystem::path& file, const Sequence& sequence) {
  std::map<std::int64_t, Timestamp> stamp_of;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i)
    if (const auto number = imageNumber(sequence.frames[i].left)) stamp_of.emplace(*number, sequence.stamps[i]);
  StampedPoses known;
  for (const TextLine& line : readPoseLines(file)) {
    FieldReader fields(file, line);
    const std::int64_t number = fields.integer("the number of an image");
    const SE3 pose = fields.pose("a pose");
    if (const auto found = stamp_of.find(number); found != stamp_of.end()) append(known, found->second, pose, fields);
  }
  return known;
}

std::optional<StampedPoses> readTimedPoses(const std::filesystem::path& file, const Sequence& sequence) {
  const auto lines = readPoseLines(file);
  switch (lines.empty() ? PoseForm::kRows : poseFormOf(file, lines)) {
    case PoseForm::kRows:
      break;
    case PoseForm::kTum:
      return onImageClock(readTumPoses(file), file, sequence);
    case PoseForm::kEuroc:
      return onImageClock(readStampedPoses(file), file, sequence);
    case PoseForm::kNumbered:
      return readNumberedPoses(file, sequence);
  }
  return std::nullopt;
}

}  // namespace motorcade
