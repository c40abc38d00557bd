#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/se2.hpp"
#include "core/se3.hpp"

namespace motorcade {

/// A pose graph as in g2o files: poses, either all in the plane or all in space, and measured motions between them.
struct PoseGraph {
  using Pose = std::variant<SE3, SE2>;
  /// 3x3 in the plane, 6x6 in space, translation first; positive semidefinite. Without a heap allocation.
  using Information = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;

  struct Vertex {
    std::int64_t id = 0;
    Pose pose;
  };
  struct Edge {
    std::int64_t from = 0, to = 0;
    int line = 0;
    Pose measured;  // T_from_to
    Information information;
    bool definite = true;  // the information leaves no direction open
  };
  /// A fault that leaves the rest of the graph usable.
  struct Problem {
    enum class Kind { kNotFinite, kNotPositiveDefinite, kDuplicateVertex, kSelfEdge, kRepeatedEdge };
    Kind kind;
    int line;
    std::string name;    // its subject: "pose 17", "edge from pose 3 to pose 4"
    std::string detail;  // names the line and what became of it
    std::vector<std::int64_t> poses;
  };

  bool planar = false;
  std::vector<std::int64_t> poses;       // every pose that the file names, ascending
  std::vector<Vertex> vertices;          // as the file lists them: often none, or only initial guesses
  std::vector<Edge> edges;               // in the file's order
  std::vector<std::int64_t> frame_ends;  // of the FRAME lines: the last pose of each frame
  std::vector<std::int64_t> fixed;       // of the FIX lines
  std::vector<Problem> problems;
};

std::string_view nameOf(PoseGraph::Problem::Kind kind);

/// Reads VERTEX_SE2, EDGE_SE2, VERTEX_SE3:QUAT, EDGE_SE3:QUAT, FIX and FRAME lines. Passes over PARAMS lines, which
/// other kinds of edges need. Throws an InputError that names file, line and remedy for a line that is not g2o. Leaves
/// out edges that are not finite, have negative information or join a pose to itself. Keeps the first of vertices with
/// the same id. What is left out becomes a problem.
PoseGraph readPoseGraph(const std::filesystem::path& file);

/// Numbers are written with all their digits. Throws OutputError.
void writePoseGraph(const std::filesystem::path& file, const PoseGraph& graph);

}  // namespace motorcade
