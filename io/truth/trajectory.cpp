#include "io/truth/trajectory.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <string>
#include <string_view>

#include <Eigen/Geometry>

#include "io/files/errors.hpp"
#include "io/files/line_file.hpp"
#include "io/files/number_text.hpp"
#include "io/files/text_file.hpp"

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

namespace {

std::size_t fieldsIn(const std::filesystem::path& file, const TextLine& line) {
  FieldReader fields(file, line, separatorOf(line));
  std::size_t count = 0;
  for (; !fields.atEnd(); ++count) fields.word("a pose");
  return count;
}

/// True for a line that begins with a word. The letters of nan and inf alone are no word.
bool beginsWithAWord(const TextLine& line) {
  const std::string text = trimmed(line.text), word = text.substr(0, text.find_first_of(" \t,"));
  constexpr std::string_view kOfNumbers = "nNaAiIfF";
  return !word.empty() && std::isalpha(static_cast<unsigned char>(word.front())) != 0 &&
         word.find_first_not_of(kOfNumbers) != std::string::npos;
}

/// Guesses another form from the number of fields, and adds how to convert it where possible.
std::string guessAt(std::size_t fields) {
  switch (fields) {
    case 3:
      return "as places without attitudes have";
    case 4:
      return "as a matrix over four lines has: write each into one line";
    case 6:
      return "as places with three angles have";
    case 7:
      return "as a TUM trajectory without its times has: write the time before each";
    case 13:
      return "as KITTI-360's poses of the inertial unit have: take those of the camera, cam0_to_world.txt";
    default:
      return "which is no form of a pose that is known";
  }
}

}  // namespace

char separatorOf(const TextLine& line) { return line.text.find(',') == std::string::npos ? ' ' : ','; }

std::vector<TextLine> readPoseLines(const std::filesystem::path& file) {
  std::vector<TextLine> lines = readLines(file);
  std::erase_if(lines, [](const TextLine& line) { return trimmed(line.text).starts_with('#'); });
  const bool has_header = lines.size() > 1 && beginsWithAWord(lines[0]) && !beginsWithAWord(lines[1]);
  if (has_header) lines.erase(lines.begin());
  return lines;
}

PoseForm poseFormOf(const std::filesystem::path& file, const std::vector<TextLine>& lines) {
  if (lines.empty()) throw InputError(file.string() + ": has no poses");
  const TextLine& line = lines.front();
  const std::size_t fields = fieldsIn(file, line);
  const bool commas = separatorOf(line) == ',';
  if (fields == 12 || fields == 16) return PoseForm::kRows;
  if (commas && fields >= 8) return PoseForm::kEuroc;
  if (fields == 8) return PoseForm::kTum;
  if (fields == 17) return PoseForm::kNumbered;
  throw InputError(file.string() + ", line " + std::to_string(line.number) + ": has " + std::to_string(fields) +
                   " fields, " + guessAt(fields) +
                   ". A line of poses is 12 numbers, the upper three rows of T_world_cam, row by row; or 16, all four "
                   "rows; or a trajectory in TUM form, time tx ty tz qx qy qz qw; or in EuRoC's, with commas, time in "
                   "ns,tx,ty,tz,qw,qx,qy,qz");
}

}  // namespace motorcade
