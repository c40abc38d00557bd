#include "io/results/pose_graph.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <span>
#include <unordered_map>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "core/decompositions.hpp"
#include "io/files/errors.hpp"
#include "io/files/line_file.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

using Kind = PoseGraph::Problem::Kind;

constexpr std::size_t kMaxNumbers = 28;  // of an edge in space: 7 of the measurement, 21 of the information

/// Fields of a line with a known tag.
struct TagFormat {
  std::string_view tag;
  bool planar;
  std::size_t ids, pose_numbers, information_numbers;
};
constexpr std::array<TagFormat, 4> kFormats{{
    {"VERTEX_SE2", true, 1, 3, 0},
    {"EDGE_SE2", true, 2, 3, 6},
    {"VERTEX_SE3:QUAT", false, 1, 7, 0},
    {"EDGE_SE3:QUAT", false, 2, 7, 21},
}};

std::string_view takeLine(std::string_view& rest) {
  const auto end = rest.find('\n');
  const std::string_view line = rest.substr(0, end);
  rest.remove_prefix(end == std::string_view::npos ? rest.size() : end + 1);
  return line;
}

/// Splits off a word by hand. The library's search for one of several characters took half of a file's time.
std::string_view takeWord(std::string_view& rest) {
  const auto blank = [](char c) { return c == ' ' || (c >= '\t' && c <= '\r'); };
  const char *at = rest.data(), *const end = at + rest.size();
  while (at != end && blank(*at)) ++at;
  const char* const begin = at;
  while (at != end && !blank(*at)) ++at;
  rest = {at, static_cast<std::size_t>(end - at)};
  return {begin, static_cast<std::size_t>(at - begin)};
}

/// Numbers beyond the range of double become infinite or zero.
std::optional<double> numberOf(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (end != word.data() + word.size() || error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc::result_out_of_range) value = std::strtod(std::string(word).c_str(), nullptr);
  return value;
}

/// Finite, and not too large.
bool allUsable(std::span<const double> numbers) {
  return std::ranges::all_of(numbers, [](double n) { return std::abs(n) <= kLargestNumber; });
}

/// Advises how to mend a line with an unknown tag; empty for tags without specific advice.
std::string adviceFor(std::string_view tag) {
  const auto has = [&](std::string_view part) { return tag.find(part) != std::string_view::npos; };
  if (tag.starts_with("TUTORIAL_")) return "take the prefix off all lines: sed -i 's/^TUTORIAL_//' FILE";
  if (tag == "VERTEX_SE3" || tag == "EDGE_SE3")
    return "write " + std::string(tag) + ":QUAT, without blanks in it, and the rotation as qx qy qz qw";
  if (has("PRIOR")) return "a measurement of one pose alone is not used: remove the line, and hold a pose with FIX";
  if (has("XY") || has("CAM") || has("LANDMARK") || has("PROJECT"))
    return "landmarks and cameras are not solved: remove their VERTEX and EDGE lines";
  if (tag == "VERTEX2" || tag == "EDGE2" || tag == "VERTEX3" || tag == "EDGE3")
    return "this is TORO's form, which orders the information differently: convert it to g2o's";
  return "";
}

/// Quotes a word for an error message.
std::string shown(std::string_view word) {
  std::string text = "'";
  return text.append(printable(word)).append("'");
}

/// Builds the matrix from its upper triangle, row by row.
PoseGraph::Information informationOf(std::span<const double> upper, int size) {
  PoseGraph::Information information(size, size);
  std::size_t next = 0;
  for (int row = 0; row < size; ++row)
    for (int column = row; column < size; ++column) information(row, column) = information(column, row) = upper[next++];
  return information;
}

/// True when the information is negative in some direction by more than rounding.
bool isNegative(const PoseGraph::Information& information) {
  constexpr double kRounding = 1e-9;
  const Eigen::VectorXd diagonal = information.diagonal();
  if (!(diagonal.minCoeff() >= 0)) return true;
  const Eigen::VectorXd scale = (diagonal.array() > 0).select(diagonal.cwiseSqrt().cwiseInverse(), 1.0);  // m and rad
  const Eigen::MatrixXd scaled = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::VectorXd values = SymmetricEigen(scaled).values;
  return !(values.minCoeff() >= -kRounding * std::max(1.0, values.maxCoeff()));
}

/// Reads a file line by line. Knows its position, for errors and problems.
class Reader {
 public:
  explicit Reader(const std::filesystem::path& file) : file_(file), content_(readWhole(file)) {}
  PoseGraph read();

 private:
  void readLine(std::string_view tag, std::string_view rest);
  void readIds(std::string_view tag, std::string_view rest, std::vector<std::int64_t>& ids);
  void readElement(const TagFormat& format, std::string_view rest);
  void addVertex(std::int64_t id, std::span<const double> numbers);
  void addEdge(std::int64_t from, std::int64_t to, std::span<const double> pose, std::span<const double> information);
  PoseGraph::Pose poseOf(std::span<const double> numbers) const;

  std::int64_t idOf(std::string_view word) const;
  void report(Kind kind, std::int64_t pose, const std::string& detail) {
    graph_.problems.push_back(
        {kind, line_, "pose " + std::to_string(pose), "line " + std::to_string(line_) + ": " + detail, {pose}});
  }
  void report(Kind kind, std::int64_t from, std::int64_t to, const std::string& detail) {
    const std::string name = "edge from pose " + std::to_string(from) + " to pose " + std::to_string(to);
    graph_.problems.push_back({kind, line_, name, "line " + std::to_string(line_) + ": " + detail, {from, to}});
  }
  [[noreturn]] void fail(const std::string& message) const {
    throw InputError(file_.string() + ", line " + std::to_string(line_) + ": " + message);
  }

  const std::filesystem::path& file_;
  std::string content_;
  int line_ = 0;
  std::string_view tag_of_space_;  // the first tag of a pose or an edge tells whether all are in the plane or in space
  std::unordered_map<std::int64_t, int> line_of_vertex_;
  std::unordered_map<std::string_view, int> line_of_edge_;  // by its text
  PoseGraph graph_;
};

PoseGraph Reader::read() {
  std::string_view rest = content_;
  if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);
  const auto lines = static_cast<std::size_t>(std::ranges::count(rest, '\n')) + 1;
  graph_.edges.reserve(lines);
  line_of_edge_.reserve(lines);
  while (!rest.empty()) {
    ++line_;
    std::string_view fields = takeLine(rest);
    fields = fields.substr(0, fields.find('#'));
    const std::string_view tag = takeWord(fields);
    if (!tag.empty()) readLine(tag, fields);
  }
  if (tag_of_space_.empty()) {
    throw InputError(file_.string() + ": holds no pose and no edge; a g2o file has EDGE_SE2 or EDGE_SE3:QUAT lines");
  }
  std::ranges::sort(graph_.poses);
  graph_.poses.erase(std::unique(graph_.poses.begin(), graph_.poses.end()), graph_.poses.end());
  return std::move(graph_);
}

void Reader::readLine(std::string_view tag, std::string_view rest) {
  if (tag == "FIX") return readIds(tag, rest, graph_.fixed);
  if (tag == "FRAME") return readIds(tag, rest, graph_.frame_ends);
  if (tag.starts_with("PARAMS_")) return;
  for (const TagFormat& format : kFormats)
    if (tag == format.tag) return readElement(format, rest);
  const std::string advice = adviceFor(tag);
  fail("unknown tag " + shown(tag) + ": " +
       (advice.empty() ? "remove the line, or write it as one of" : advice + "; known are") +
       " VERTEX_SE2, EDGE_SE2, VERTEX_SE3:QUAT, EDGE_SE3:QUAT, FIX, FRAME");
}

void Reader::readIds(std::string_view tag, std::string_view rest, std::vector<std::int64_t>& ids) {
  const std::size_t before = ids.size();
  for (std::string_view word = takeWord(rest); !word.empty(); word = takeWord(rest)) ids.push_back(idOf(word));
  const std::size_t count = ids.size() - before;
  if (count == 0 || (tag == "FRAME" && count != 1)) {
    fail(std::string(tag) + " is followed by " + std::to_string(count) + " ids; give it the id of " +
         (tag == "FRAME" ? "the last pose of the frame" : "one pose or more"));
  }
}

void Reader::readElement(const TagFormat& format, std::string_view rest) {
  if (tag_of_space_.empty()) {
    tag_of_space_ = format.tag;
    graph_.planar = format.planar;
  }
  if (format.planar != graph_.planar) {
    fail(std::string(format.tag) + " after " + std::string(tag_of_space_) +
         ": a graph is in the plane or in space; make them two files");
  }
  const std::string_view text = rest;
  std::array<std::int64_t, 2> ids{};
  std::array<double, kMaxNumbers> numbers;
  const std::size_t needed = format.pose_numbers + format.information_numbers;
  std::size_t count = 0;
  for (std::string_view word = takeWord(rest); !word.empty(); word = takeWord(rest), ++count) {
    if (count < format.ids) {
      ids[count] = idOf(word);
    } else if (count < format.ids + needed) {
      const auto number = numberOf(word);
      if (!number)
        fail(shown(word) + " stands where a number belongs; write a decimal number" +
             (word.find(',') == std::string_view::npos ? "" : ", with a point: sed -i 's/,/./g' FILE"));
      numbers[count - format.ids] = *number;
    }
  }
  if (count == format.ids + format.pose_numbers && format.information_numbers > 0)
    fail(std::string(format.tag) + " has no information: append its upper triangle, row by row, for unit weights" +
         (format.planar ? " 1 0 0 1 0 1" : " 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1"));
  if (count != format.ids + needed) {
    fail(std::string(format.tag) + " is followed by " + std::to_string(count) + " fields; give it " +
         std::to_string(format.ids + needed) + ": " + (format.ids == 1 ? "an id and " : "two ids, ") +
         std::to_string(format.pose_numbers) + " numbers of the " +
         (format.ids == 1 ? "pose"
                          : "measurement and " + std::to_string(format.information_numbers) +
                                " of the information's upper triangle"));
  }
  graph_.poses.insert(graph_.poses.end(), ids.begin(), ids.begin() + static_cast<std::ptrdiff_t>(format.ids));
  const std::span<const double> all(numbers.data(), needed);
  if (format.ids == 1) return addVertex(ids[0], all);
  const auto [same, is_new] = line_of_edge_.emplace(text, line_);
  if (!is_new) {
    report(Kind::kRepeatedEdge, ids[0], ids[1],
           "says the same as line " + std::to_string(same->second) + "; both count");
  }
  addEdge(ids[0], ids[1], all.first(format.pose_numbers), all.subspan(format.pose_numbers));
}

void Reader::addVertex(std::int64_t id, std::span<const double> numbers) {
  const auto [first, is_new] = line_of_vertex_.emplace(id, line_);
  if (!is_new)
    return report(Kind::kDuplicateVertex, id, "is given again; line " + std::to_string(first->second) + " is kept");
  if (!allUsable(numbers)) {
    report(Kind::kNotFinite, id, "its value is not finite or too large; left out");
    graph_.vertices.push_back({id, graph_.planar ? PoseGraph::Pose(SE2{}) : PoseGraph::Pose(SE3{})});
    return;
  }
  graph_.vertices.push_back({id, poseOf(numbers)});
}

void Reader::addEdge(std::int64_t from, std::int64_t to, std::span<const double> pose,
                     std::span<const double> information) {
  if (!allUsable(pose))
    return report(Kind::kNotFinite, from, to, "the measurement is not finite or too large; left out");
  if (!allUsable(information))
    return report(Kind::kNotFinite, from, to, "the information is not finite or too large; left out");
  PoseGraph::Edge edge{from, to, line_, poseOf(pose), informationOf(information, graph_.planar ? 3 : 6)};
  if (from == to) return report(Kind::kSelfEdge, from, to, "joins a pose to itself; left out");
  edge.definite = edge.information.llt().info() == Eigen::Success;
  if (!edge.definite && isNegative(edge.information)) {
    return report(Kind::kNotPositiveDefinite, from, to,
                  "the information is negative in some direction; left out: give an inverse covariance, row by row "
                  "from the diagonal");
  }
  graph_.edges.push_back(edge);
}

PoseGraph::Pose Reader::poseOf(std::span<const double> numbers) const {
  if (graph_.planar) return SE2(numbers[2], {numbers[0], numbers[1]});
  const Eigen::Quaterniond q(numbers[6], numbers[3], numbers[4], numbers[5]);
  const double norm = q.coeffs().stableNorm();
  if (!(norm > 1e-6)) fail("the quaternion is zero; a rotation needs qx qy qz qw of length one, 0 0 0 1 for none");
  return SE3(Eigen::Quaterniond(q.coeffs() / norm).toRotationMatrix(), {numbers[0], numbers[1], numbers[2]});
}

std::int64_t Reader::idOf(std::string_view word) const {
  std::int64_t id = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), id);
  if (error != std::errc() || end != word.data() + word.size())
    fail(shown(word) + " stands where an id belongs; ids are whole numbers");
  if (id < 0) fail("the id " + printable(word) + " is negative; number the poses from 0");
  return id;
}

/// The shortest digits that read back as the same number.
void append(std::string& text, double value) {
  char buffer[32];
  text += ' ';
  text.append(buffer, std::to_chars(buffer, buffer + sizeof(buffer), value + 0.0).ptr);
}

void append(std::string& text, const PoseGraph::Pose& pose) {
  if (const auto* planar = std::get_if<SE2>(&pose)) {
    for (const double value : {planar->translation().x(), planar->translation().y(), planar->angle_rad()})
      append(text, value);
    return;
  }
  const SE3& T = std::get<SE3>(pose);
  Eigen::Quaterniond q(T.rotation());
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  for (const double value : {T.translation().x(), T.translation().y(), T.translation().z(), q.x(), q.y(), q.z(), q.w()})
    append(text, value);
}

void append(std::string& text, const PoseGraph::Edge& edge, std::string_view tag) {
  text.append(tag).append(" ").append(std::to_string(edge.from)).append(" ").append(std::to_string(edge.to));
  append(text, edge.measured);
  for (Eigen::Index row = 0; row < edge.information.rows(); ++row)
    for (Eigen::Index column = row; column < edge.information.cols(); ++column)
      append(text, edge.information(row, column));
  text += '\n';
}

}  // namespace

std::string_view nameOf(PoseGraph::Problem::Kind kind) {
  switch (kind) {
    case Kind::kNotFinite:
      return "not_finite";
    case Kind::kNotPositiveDefinite:
      return "not_positive_definite";
    case Kind::kDuplicateVertex:
      return "duplicate_vertex";
    case Kind::kSelfEdge:
      return "self_edge";
    case Kind::kRepeatedEdge:
      return "repeated_edge";
  }
  return "";
}

PoseGraph readPoseGraph(const std::filesystem::path& file) { return Reader(file).read(); }

void writePoseGraph(const std::filesystem::path& file, const PoseGraph& graph) {
  std::string text;
  for (const auto& vertex : graph.vertices) {
    text.append(graph.planar ? "VERTEX_SE2 " : "VERTEX_SE3:QUAT ").append(std::to_string(vertex.id));
    append(text, vertex.pose);
    text += '\n';
  }
  for (const std::int64_t id : graph.fixed) text.append("FIX ").append(std::to_string(id)).append("\n");
  for (const auto& edge : graph.edges) append(text, edge, graph.planar ? "EDGE_SE2" : "EDGE_SE3:QUAT");
  for (const std::int64_t id : graph.frame_ends) text.append("FRAME ").append(std::to_string(id)).append("\n");
  writeAtOnce(file, text);
}

}  // namespace motorcade
