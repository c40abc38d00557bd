#pragma once

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "io/results/pose_graph.hpp"
#include "tests/io/temporary_folder.hpp"

/// `motorcade solve` from outside, on small graphs that the tests write.
namespace motorcade::test {

inline const std::string kUnit3 = " 1 0 0 1 0 1\n";
inline const std::string kUnit6 = " 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n";

/// A motion of one meter ahead and a quarter turn to the left.
inline std::string quarterTurn(int from, int to) {
  return "EDGE_SE2 " + std::to_string(from) + " " + std::to_string(to) + " 1 0 1.5707963267948966" + kUnit3;
}
/// The same motion backwards.
inline std::string quarterTurnBack(int from, int to) {
  return "EDGE_SE2 " + std::to_string(from) + " " + std::to_string(to) + " 0 1 -1.5707963267948966" + kUnit3;
}
/// One meter ahead, in space.
inline std::string ahead(int from, int to) {
  return "EDGE_SE3:QUAT " + std::to_string(from) + " " + std::to_string(to) + " 1 0 0 0 0 0 1" + kUnit6;
}

/// Runs the program in a folder of its own.
class SolvedGraph : public testing::Test {
 protected:
  /// Runs the program and returns its exit code.
  int solve(const std::filesystem::path& graph, const std::string& options = "", const std::string& prefix = "") {
    const std::string command = prefix + MOTORCADE_PROGRAM + " solve " + graph.string() + " --json " +
                                (folder_ / "solve.json").string() + " --out " + (folder_ / "out.g2o").string() + " " +
                                options + " >" + (folder_ / "stdout").string() + " 2>" + (folder_ / "stderr").string();
    return WEXITSTATUS(std::system(command.c_str()));
  }
  /// Solves a graph that must be accepted, and returns the program's results.
  nlohmann::json solved(const std::string& content, const std::string& options = "") {
    return solvedFile(folder_.write("graph.g2o", content), options);
  }
  /// Solves a graph that leaves something open, and returns the program's results.
  nlohmann::json unsolved(const std::string& content, const std::string& options = "") {
    EXPECT_EQ(solve(folder_.write("graph.g2o", content), options), 3);
    EXPECT_THAT(folder_.read("stderr"), testing::HasSubstr("graph.g2o: could not be solved: "));
    nlohmann::json result = nlohmann::json::parse(folder_.read("solve.json"));
    EXPECT_EQ(result["solved"], false);
    return result;
  }
  nlohmann::json solvedFile(const std::filesystem::path& graph, const std::string& options = "") {
    EXPECT_EQ(solve(graph, options), 0) << folder_.read("stderr");
    return nlohmann::json::parse(folder_.read("solve.json"));
  }
  std::string errorOf(const std::string& content) {
    EXPECT_EQ(solve(folder_.write("graph.g2o", content)), 3);
    return folder_.read("stderr");
  }
  /// The pose of a vertex in the written graph.
  SE2 planarPose(std::int64_t id) const {
    for (const auto& vertex : readPoseGraph(folder_ / "out.g2o").vertices)
      if (vertex.id == id) return std::get<SE2>(vertex.pose);
    ADD_FAILURE() << "pose " << id << " is not there";
    return {};
  }
  std::string printed() const { return folder_.read("stdout"); }

  static std::vector<std::string> kinds(const nlohmann::json& result) {
    std::vector<std::string> kinds;
    for (const auto& problem : result["problems"]) kinds.push_back(problem["kind"]);
    return kinds;
  }

  TemporaryFolder folder_;
};

inline const SE2 kQuarterTurn(std::acos(0.0), {1, 0});
inline constexpr double kTol = 1e-6;  // of a converged solution without noise

}  // namespace motorcade::test
