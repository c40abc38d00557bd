#include "io/stamped_poses.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <Eigen/Geometry>

#include "io/layouts/layout_parts.hpp"
#include "io/text_file.hpp"

namespace motorcade {
namespace {

/// Appends a pose, which must be later than the one before.
void append(StampedPoses& known, Timestamp stamp, const SE3& pose, const FieldReader& fields) {
  if (!known.stamps.empty() && stamp <= known.stamps.back()) fields.fail("the pose is not later than the one before");
  known.stamps.push_back(stamp);
  known.poses.push_back(pose);
}

}  // namespace

StampedPoses readStampedPoses(const std::filesystem::path& file) {
  constexpr double kLength = 1e-2;  // by which a quaternion's may be off
  StampedPoses known;
  for (const TextLine& line : readLines(file)) {
    if (line.text.starts_with('#')) continue;
    FieldReader fields(file, line, ',');
    const Timestamp stamp{fields.integer("a time in nanoseconds")};
    std::array<double, 7> values{};
    for (double& value : values) value = fields.number("a pose");
    const Eigen::Quaterniond q(values[3], values[4], values[5], values[6]);
    if (std::abs(q.norm() - 1) > kLength) fields.fail("the quaternion's length is not 1");
    append(known, stamp, {q.normalized().toRotationMatrix(), {values[0], values[1], values[2]}}, fields);
  }
  return known;
}

StampedPoses readNumberedPoses(const std::filesystem::path& file, const Sequence& sequence) {
  std::map<std::int64_t, Timestamp> stamp_of;
  for (std::size_t i = 0; i < sequence.frames.size(); ++i)
    if (const auto number = imageNumber(sequence.frames[i].left)) stamp_of.emplace(*number, sequence.stamps[i]);
  StampedPoses known;
  for (const TextLine& line : readLines(file)) {
    FieldReader fields(file, line);
    const std::int64_t number = fields.integer("the number of an image");
    const SE3 pose = fields.pose("a pose");
    if (const auto found = stamp_of.find(number); found != stamp_of.end()) append(known, found->second, pose, fields);
  }
  return known;
}

SE3 poseAt(Timestamp stamp, const std::vector<SE3>& poses, const std::vector<Timestamp>& stamps) {
  const auto after = std::ranges::upper_bound(stamps, stamp) - stamps.begin();
  const std::size_t i = std::clamp<std::ptrdiff_t>(after - 1, 0, std::ssize(stamps) - 2);
  const double part = secondsBetween(stamps[i], stamp) / secondsBetween(stamps[i], stamps[i + 1]);
  const auto &from = poses[i], &to = poses[i + 1];
  return {from.rotation() * expSO3(part * logSO3(from.rotation().transpose() * to.rotation())),
          from.translation() + part * (to.translation() - from.translation())};
}

}  // namespace motorcade
