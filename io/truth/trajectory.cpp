#include "io/truth/trajectory.hpp"

#include <cmath>

#include <Eigen/Geometry>

#include "io/files/errors.hpp"
#include "io/files/line_file.hpp"
#include "io/files/number_text.hpp"
#include "io/files/text_file.hpp"
#include "io/truth/pose_form.hpp"

namespace motorcade {
namespace {

/// The fourth row of a pose, 0 0 0 1.
void expectLastRow(FieldReader& fields) {
  constexpr double kPrinted = 1e-6;
  for (const double expected : {0.0, 0.0, 0.0, 1.0})
    if (std::abs(fields.number("the last row of a pose") - expected) > kPrinted)
      fields.fail("the last row of the pose is not 0 0 0 1; are the matrices written column by column?");
}

}  // namespace

std::string kittiLine(const SE3& T_world_cam) {
  std::string line;
  line.reserve(220);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      if (!line.empty()) line += ' ';
      appendScientific(line, column < 3 ? T_world_cam.rotation()(row, column) : T_world_cam.translation()[row], 9);
    }
  }
  return line;
}

std::string tumLine(Timestamp stamp, const SE3& T_world_cam) {
  constexpr std::int64_t kNanosPerSecond = 1'000'000'000;
  std::string line = stamp.ns < 0 ? "-" : "";
  const std::int64_t magnitude_ns = stamp.ns < 0 ? -stamp.ns : stamp.ns;
  const std::string fraction = std::to_string(magnitude_ns % kNanosPerSecond);
  line += std::to_string(magnitude_ns / kNanosPerSecond) + '.' + std::string(9 - fraction.size(), '0') + fraction;
  Eigen::Quaterniond q(T_world_cam.rotation());
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  for (const double value : {T_world_cam.translation().x(), T_world_cam.translation().y(),
                             T_world_cam.translation().z(), q.x(), q.y(), q.z(), q.w()}) {
    line += ' ';
    appendFixed(line, value, 9);
  }
  return line;
}

std::vector<SE3> readKittiPoses(const std::filesystem::path& file) {
  const auto lines = readPoseLines(file);
  std::vector<SE3> poses;
  if (lines.empty()) return poses;
  if (poseFormOf(file, lines) != PoseForm::kRows)
    throw InputError(file.string() + ": is a trajectory with times or numbers; poses without them are needed here, " +
                     "12 numbers a line, one line for each frame");
  for (const auto& line : lines) {
    FieldReader fields(file, line, separatorOf(line));
    poses.push_back(fields.pose("a pose"));
    if (!fields.atEnd()) expectLastRow(fields);
    fields.expectEnd();
  }
  return poses;
}

void writeKittiPoses(const std::filesystem::path& file, const std::vector<SE3>& poses) {
  LineFile out(file);
  for (const auto& pose : poses) out.writeLine(kittiLine(pose));
  out.close();
}

}  // namespace motorcade
