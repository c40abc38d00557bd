#include <cmath>
#include <string>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/apps/solve/solved_graph.hpp"
#include "tests/support/matchers.hpp"

/// Tests the gauge of a pose graph: what holds it in place, and which directions nothing determines.
namespace motorcade {
namespace {

using nlohmann::json;
using test::ahead;
using test::IsNearPose;
using test::kTol;
using test::kUnit3;
using test::kUnit6;
using test::quarterTurn;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using SolveGauge = test::SolvedGraph;

constexpr double kExact = 1e-14;  // rounding of the comparison

TEST_F(SolveGauge, AFixedPoseStaysWhereItsVertexIs) {
  const std::string vertices = "VERTEX_SE2 0 10 20 1.0\nVERTEX_SE2 1 11 20 1.0\n",
                    edge = "EDGE_SE2 0 1 1 0 0 100 0 0 100 0 100\n";
  for (const std::string& fixed : {std::string("FIX 0\n"), std::string()}) {
    std::string graph = vertices;
    graph += fixed;
    graph += edge;
    solved(graph);
    EXPECT_THAT(planarPose(0), IsNearPose(SE2(1, {10, 20}), kExact));
    EXPECT_THAT(planarPose(1), IsNearPose(SE2(1, {10 + std::cos(1.0), 20 + std::sin(1.0)}), kTol));
  }
  EXPECT_EQ(readPoseGraph(folder_ / "out.g2o").fixed.size(), 0U);
  solved(vertices + "FIX 1\n" + edge, "--batch");
  EXPECT_THAT(planarPose(1), IsNearPose(SE2(1, {11, 20}), kExact));
  EXPECT_THAT(planarPose(0), IsNearPose(SE2(1, {11 - std::cos(1.0), 20 - std::sin(1.0)}), kTol));
  EXPECT_EQ(readPoseGraph(folder_ / "out.g2o").fixed.size(), 1U);
}

TEST_F(SolveGauge, AFixedPoseInSpaceStaysWhereItsVertexIs) {
  const json result = solved("VERTEX_SE3:QUAT 2 5 6 7 0 0 0.6 0.8\nFIX 2\n" + ahead(0, 1) + ahead(1, 2) + ahead(2, 3));
  EXPECT_NEAR(result["chi2"], 0, kTol);
  const SE3 T_world_2(Eigen::Quaterniond(0.8, 0, 0, 0.6).toRotationMatrix(), {5, 6, 7});
  const auto vertices = readPoseGraph(folder_ / "out.g2o").vertices;
  EXPECT_THAT(std::get<SE3>(vertices.at(2).pose), IsNearPose(T_world_2, 1e-14));
  EXPECT_THAT(std::get<SE3>(vertices.at(0).pose),
              IsNearPose(T_world_2 * SE3(Eigen::Matrix3d::Identity(), {-2, 0, 0}), kTol));
}

/// Three poses on a line whose ends are held one meter too far apart: the edges' weights share it at the middle one.
TEST_F(SolveGauge, SeveralFixedPosesAllStayAndTheEdgesGiveWay) {
  const std::string ends = "VERTEX_SE2 4 1 0 0\nVERTEX_SE2 6 4 0 0\nFIX 4 6\n",
                    edges =
                        "EDGE_SE2 4 5 1 0 0 300 0 0 300 0 300\nEDGE_SE2 5 6 1 0 0 100 0 0 100 0 100\n"
                        "EDGE_SE2 4 6 2 0 0 7 0 0 7 0 7\nEDGE_SE2 3 4 1 0 0" +
                        kUnit3 + "EDGE_SE2 6 7 1 0 0" + kUnit3;
  for (const char* options : {"", "--batch", "--policy every"}) {
    const json result = solved(ends + edges, options);
    EXPECT_THAT(planarPose(4), IsNearPose(SE2(0, {1, 0}), kExact));
    EXPECT_THAT(planarPose(6), IsNearPose(SE2(0, {4, 0}), kExact));
    EXPECT_THAT(planarPose(5), IsNearPose(SE2(0, {2.25, 0}), kTol));
    EXPECT_THAT(planarPose(3), IsNearPose(SE2(0, {0, 0}), kTol));
    EXPECT_THAT(planarPose(7), IsNearPose(SE2(0, {5, 0}), kTol));
    EXPECT_NEAR(result["chi2"], 300 * 0.25 * 0.25 + 100 * 0.75 * 0.75 + 7, kTol) << "the edge between them counts, too";
    EXPECT_EQ(result["poses"], 5);
    EXPECT_EQ(result["edges"], 5);
  }
}

TEST_F(SolveGauge, AnEdgeThatLeavesADirectionOpenCountsWhereTheRestTellsIt) {
  // Only where pose 1 is, not its heading; that comes from pose 2, which comes later.
  const std::string open = "EDGE_SE2 0 1 1 0 3 100 0 0 100 0 0\n";
  const json result = solved(open + "EDGE_SE2 0 2 2 0 0" + kUnit3 + "EDGE_SE2 1 2 1 0 0" + kUnit3, "--batch");
  EXPECT_THAT(result["problems"], IsEmpty());
  EXPECT_EQ(result["edges"], 3);
  EXPECT_THAT(planarPose(1), IsNearPose(SE2(0, {1, 0}), kTol));
  EXPECT_NEAR(result["chi2"], 0, kTol);
  const std::string in_space = "EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 0 0 0 0 0 0\n";
  EXPECT_THAT(solved(in_space + ahead(1, 2) + "EDGE_SE3:QUAT 0 2 2 0 0 0 0 0 1" + kUnit6)["problems"], IsEmpty());
}

TEST_F(SolveGauge, ADirectionThatNothingTellsEndsWithItsName) {
  const json heading = unsolved("VERTEX_SE2 0 0 0 0\nVERTEX_SE2 1 1 0 0\nEDGE_SE2 0 1 1 0 0 100 0 0 100 0 0\n");
  ASSERT_THAT(kinds(heading), ElementsAre("unconstrained"));
  EXPECT_EQ(heading["problems"][0]["name"], "pose 1");
  EXPECT_THAT(folder_.read("stderr"),
              AllOf(HasSubstr("pose 1 is not constrained along rotation"), HasSubstr("pose 0")));
  EXPECT_THAT(planarPose(1), IsNearPose(SE2(0, {1, 0}), kTol));
  const json height =
      unsolved(ahead(0, 1) + "EDGE_SE3:QUAT 1 2 1 0 0 0 0 0 1 1 0 0 0 0 0 1 0 0 0 0 0 0 0 0 1 0 0 1 0 1\n", "--batch");
  EXPECT_THAT(std::string(height["problems"][0]["detail"]), HasSubstr("pose 2 is not constrained along z"));
  EXPECT_THAT(kinds(unsolved("EDGE_SE2 0 1 1 0 0 0 0 0 0 0 0\n")), ElementsAre("unconstrained"));
}

TEST_F(SolveGauge, AGraphOfWhichNoEdgeCountsIsNotSolved) {
  EXPECT_THAT(kinds(unsolved("EDGE_SE2 0 1 1 0 0 1 0 0 1 0 -1\n")),
              ElementsAre("not_positive_definite", "disconnected_part", "no_edges"));
  EXPECT_THAT(kinds(unsolved("VERTEX_SE2 0 0 0 0\n")), ElementsAre("no_edges"));
}

TEST_F(SolveGauge, FixLinesThatHoldNothingAreNamed) {
  const json result = solved("VERTEX_SE2 0 1 2 0\nFIX 0 2 99\n" + quarterTurn(0, 1) + quarterTurn(1, 2));
  ASSERT_THAT(kinds(result), ElementsAre("fix_not_applied", "fix_not_applied"));
  EXPECT_EQ(result["problems"][0]["name"], "pose 99");
  EXPECT_THAT(std::string(result["problems"][1]["detail"]), HasSubstr("no VERTEX line says where the pose is"));
  EXPECT_THAT(planarPose(0), IsNearPose(SE2(0, {1, 2}), kExact));
}

/// Each part has a pose that stays: its fixed one or its first.
TEST_F(SolveGauge, PartsThatNothingJoinsAreSolvedByThemselves) {
  const std::string main = quarterTurn(0, 1) + quarterTurn(1, 2),
                    loop = quarterTurn(10, 11) + quarterTurn(11, 12) + "EDGE_SE2 12 10 1 1 3" + kUnit3;
  const double of_loop = solved(loop, "--batch")["chi2"];
  EXPECT_GT(of_loop, 0.001);
  const json result = solved("VERTEX_SE2 11 7 8 0.5\nFIX 11\nVERTEX_SE2 30 4 5 0\n" + main + loop, "--batch");
  ASSERT_THAT(kinds(result), ElementsAre("disconnected_part", "disconnected_part"));
  EXPECT_THAT(
      std::string(result["problems"][0]["detail"]),
      AllOf(HasSubstr("no edge joins it to the rest, which is held by pose 0"), HasSubstr("with pose 11 held")));
  EXPECT_NEAR(result["chi2"], of_loop, kTol);
  EXPECT_EQ(result["edges"], 5);
  EXPECT_THAT(planarPose(11), IsNearPose(SE2(0.5, {7, 8}), kExact));
  EXPECT_THAT(planarPose(30), IsNearPose(SE2(0, {4, 5}), kExact));
  EXPECT_THAT(planarPose(0), IsNearPose(SE2{}, kTol));
}

}  // namespace
}  // namespace motorcade
