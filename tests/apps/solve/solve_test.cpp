#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "apps/solve/pose_graph_feed.hpp"
#include "tests/apps/solve/solved_graph.hpp"
#include "tests/support/data_folder.hpp"
#include "tests/support/matchers.hpp"

/// `motorcade solve` from outside, on small graphs written here and on public ones; and the feed beneath it.
namespace motorcade {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test::ahead;
using test::IsNearPose;
using test::kQuarterTurn;
using test::kTol;
using test::kUnit3;
using test::kUnit6;
using test::quarterTurn;
using test::quarterTurnBack;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Solve = test::SolvedGraph;

const fs::path kGraphs = test::dataFolder() / "posegraphs";

TEST_F(Solve, ClosesASquareInThePlane) {
  const json result = solved(quarterTurn(0, 1) + quarterTurn(1, 2) + quarterTurn(2, 3) + quarterTurn(3, 0));
  EXPECT_EQ(result["poses"], 4);
  EXPECT_EQ(result["edges"], 4);
  EXPECT_EQ(result["updates"], 4);
  EXPECT_NEAR(result["chi2"], 0, kTol);
  EXPECT_GT(result["total_s"], 0);
  EXPECT_LE(result["median_ms"], result["max_ms"]);
  EXPECT_THAT(result["problems"], IsEmpty());
  EXPECT_FALSE(result.contains("update_ms"));
  EXPECT_THAT(planarPose(3), IsNearPose(kQuarterTurn * kQuarterTurn * kQuarterTurn, kTol));
  EXPECT_EQ(readPoseGraph(folder_ / "out.g2o").edges.size(), 4U);
  EXPECT_THAT(printed(), AllOf(HasSubstr("4 poses, 4 edges, 4 updates"), HasSubstr("chi2"), HasSubstr("p99")));
}

TEST_F(Solve, TakesEdgesInEitherDirectionAndIdsWithGaps) {
  EXPECT_NEAR(
      solved(quarterTurnBack(15, 7) + quarterTurnBack(22, 15) + quarterTurn(22, 40) + quarterTurn(40, 7))["chi2"], 0,
      kTol);
  EXPECT_THAT(planarPose(7), IsNearPose(SE2{}, kTol));
  EXPECT_THAT(planarPose(15), IsNearPose(kQuarterTurn, kTol));
}

TEST_F(Solve, NeverStartsFromTheValuesOfVertices) {
  const std::string edges = quarterTurn(0, 1) + quarterTurn(1, 2);
  const json without = solved(edges),
             with = solved("VERTEX_SE2 1 1e6 1e6 3\nVERTEX_SE2 2 -1e6 5 1\nVERTEX_SE2 0 9 9 9\n" + edges);
  EXPECT_EQ(without["chi2"], with["chi2"]);
  EXPECT_THAT(planarPose(2), IsNearPose(SE2(9, {9, 9}) * kQuarterTurn * kQuarterTurn, kTol))
      << "but the first pose stays";
}

TEST_F(Solve, WeighsContradictionsInSpaceByTheirInformation) {
  // Two motions of one meter and one of five between the same poses, with unit information: chi2 = 1/3 of (5 - 2)^2.
  const json result = solved(ahead(0, 1) + ahead(1, 2) + "EDGE_SE3:QUAT 0 2 5 0 0 0 0 0 1" + kUnit6);
  EXPECT_NEAR(result["chi2"], 3, kTol);
  EXPECT_EQ(result["poses"], 3);
  EXPECT_THAT(folder_.read("out.g2o"), HasSubstr("VERTEX_SE3:QUAT 2 "));
}

TEST_F(Solve, TakesAFrameInOneUpdateAndTheRestInALastOne) {
  const std::string edges = ahead(0, 1) + ahead(0, 2) + ahead(2, 3) + ahead(3, 4) + ahead(4, 5);
  EXPECT_EQ(solved(edges)["updates"], 6);
  const json result = solved(edges + "FRAME 1\nFRAME 3\n", "--updates");
  EXPECT_EQ(result["updates"], 3);
  EXPECT_EQ(result["update_ms"].size(), 3U);
  EXPECT_EQ(result["update_eliminated_scalars"].size(), 3U);
  EXPECT_EQ(result["poses"], 6);
}

TEST_F(Solve, EveryPolicyAndTheBatchSolutionAgree) {
  std::string edges = "EDGE_SE2 0 9 1.3 -0.2 1.7" + kUnit3;
  for (int i = 0; i < 9; ++i) edges += quarterTurn(i, i + 1);
  const double batch = solved(edges, "--batch")["chi2"];
  EXPECT_GT(batch, 0.005);
  // One step per update ends a little above the optimum.
  EXPECT_NEAR(solved(edges, "--policy fluid")["chi2"], batch, 0.05 * batch);
  EXPECT_NEAR(solved(edges, "--policy every --every 1")["chi2"], batch, 0.05 * batch);
}

TEST_F(Solve, ABudgetOfTimeOrScalarsEndsAtTheSameSolution) {
  std::string edges;
  for (int i = 0; i < 300; ++i) edges += ahead(i, i + 1);
  edges += "EDGE_SE3:QUAT 0 300 299 0 0 0 0 0 1" + kUnit6 + ahead(300, 301);
  const double without = solved(edges)["chi2"];
  for (const char* const options : {"--budget-ms 0.01", "--budget 1", "--budget 1 --budget-ms 5"}) {
    const json result = solved(edges, options);
    EXPECT_NEAR(result["chi2"], without, 0.02 * without) << options;
    EXPECT_GE(result["settling_updates"], 1) << options;
    EXPECT_GT(result["settling_max_ms"], 0) << options;
    EXPECT_THAT(printed(), HasSubstr("further updates")) << options;
  }
  EXPECT_FALSE(solved(edges).contains("settling_updates"));
}

TEST_F(Solve, AMeasurementThatIsNoNumberIsLeftOutAndNamed) {
  const json result =
      solved(quarterTurn(0, 1) + quarterTurn(1, 2) + "EDGE_SE2 0 2 nan 0 0" + kUnit3 + quarterTurn(2, 3));
  ASSERT_THAT(kinds(result), ElementsAre("not_finite"));
  EXPECT_EQ(result["problems"][0]["name"], "edge from pose 0 to pose 2");
  EXPECT_THAT(std::string(result["problems"][0]["detail"]), HasSubstr("line 3"));
  EXPECT_EQ(result["problems"][0]["poses"], json::array({0, 2}));
  EXPECT_EQ(result["edges"], 3);
  EXPECT_NEAR(result["chi2"], 0, kTol);
  EXPECT_THAT(printed(), AllOf(HasSubstr("pose 0"), HasSubstr("pose 2"), HasSubstr("line 3")));
}

TEST_F(Solve, EveryOtherDamageIsNamedToo) {
  const std::string good = quarterTurn(0, 1) + quarterTurn(1, 2);
  EXPECT_THAT(kinds(solved(good + "EDGE_SE2 2 0 1 0 0 1 2 0 1 0 1\n")), ElementsAre("not_positive_definite"));
  EXPECT_THAT(kinds(solved(good + "EDGE_SE2 1 1 1 0 0" + kUnit3)), ElementsAre("self_edge"));
  EXPECT_THAT(kinds(solved(good + "VERTEX_SE2 1 0 0 0\nVERTEX_SE2 1 1 0 0\n")), ElementsAre("duplicate_vertex"));
  const json twice = solved(good + quarterTurn(1, 2));
  EXPECT_THAT(kinds(twice), ElementsAre("repeated_edge"));
  EXPECT_EQ(twice["edges"], 3);
  EXPECT_THAT(kinds(solved("FIX 0 2\n" + good)), ElementsAre("fix_not_applied"));
}

TEST_F(Solve, APartThatNothingJoinsIsNamedAndTheRestIsSolved) {
  const std::string rest = quarterTurn(0, 1) + quarterTurn(1, 2) + "EDGE_SE2 0 2 1 2 3" + kUnit3;
  const std::string broken = rest + quarterTurn(17, 18) + quarterTurn(18, 19) + "VERTEX_SE2 30 0 0 0\n";
  EXPECT_EQ(solved(broken, "--batch")["chi2"], solved(rest, "--batch")["chi2"]);
  const json result = solved(broken);
  EXPECT_EQ(result["poses"], 6) << "the part counts, a pose without an edge does not";
  EXPECT_EQ(result["updates"], 7);
  ASSERT_THAT(kinds(result), ElementsAre("disconnected_part", "disconnected_part"));
  EXPECT_EQ(result["problems"][0]["name"], "poses 17-19");
  EXPECT_EQ(result["problems"][0]["poses"], json::array({17, 18, 19}));
  EXPECT_EQ(result["problems"][1]["name"], "pose 30");
  EXPECT_THAT(printed(), AllOf(HasSubstr("poses 17-19: disconnected"), HasSubstr("pose 30: disconnected")));
  EXPECT_THAT(planarPose(18), IsNearPose(kQuarterTurn, kTol)) << "along its edges, from the identity";
}

TEST_F(Solve, APartThatIsJoinedLateEntersWithTheEdgeThatJoinsIt) {
  // 2 and 3 come before 4 joins them to the rest, through an edge that points either way.
  for (const std::string& joint :
       {quarterTurn(3, 4) + quarterTurn(4, 0), quarterTurnBack(4, 3) + quarterTurnBack(0, 4)}) {
    const json result = solved(quarterTurn(0, 1) + quarterTurn(2, 3) + joint);
    EXPECT_NEAR(result["chi2"], 0, kTol);
    EXPECT_EQ(result["poses"], 5);
    ASSERT_THAT(kinds(result), ElementsAre("joined_late"));
    EXPECT_EQ(result["problems"][0]["name"], "poses 2-3");
    EXPECT_THAT(planarPose(3) * kQuarterTurn * kQuarterTurn, IsNearPose(SE2{}, kTol));
  }
}

TEST_F(Solve, AFirstPoseWithoutEdgesDoesNotHoldUpTheRest) {
  const json result = solved("EDGE_SE2 0 1 nan 0 0" + kUnit3 + quarterTurn(1, 2) + quarterTurn(2, 3));
  EXPECT_EQ(result["poses"], 3);
  EXPECT_THAT(kinds(result), ElementsAre("not_finite", "disconnected_part"));
  EXPECT_THAT(planarPose(1), IsNearPose(SE2{}, kTol));
}

TEST_F(Solve, ANumberTooLargeDoesNotSpoilTheRest) {
  const json result =
      solved(quarterTurn(0, 1) + "EDGE_SE2 0 1 1e200 0 0" + kUnit3 + "EDGE_SE2 0 1 1 0 0 1e300 0 0 1e300 0 1e300\n");
  EXPECT_THAT(kinds(result), ElementsAre("not_finite", "not_finite"));
  EXPECT_NEAR(result["chi2"], 0, kTol);
}

TEST_F(Solve, AJointThatSaysNextToNothingIsNamedWithItsMend) {
  const json result = solved(quarterTurn(0, 1) + "EDGE_SE2 1 2 1 0 0 1e-14 0 0 1e-14 0 1e-14\n" + quarterTurn(2, 3));
  ASSERT_THAT(kinds(result), ElementsAre("badly_conditioned"));
  EXPECT_THAT(std::string(result["problems"][0]["name"]), testing::AnyOf("pose 2", "pose 3"));
  EXPECT_THAT(printed(), AllOf(HasSubstr("badly conditioned in any direction"),
                               HasSubstr("bring their information closer together")));
}

/// All poses wait for the hub, which is eliminated last. Before the others it would make them a dense system, which
/// takes hours.
TEST_F(Solve, AStarWhoseHubComesLastTakesNoLongerThanOthers) {
  constexpr int kPoses = 20'000;
  std::string star;
  for (int pose = 0; pose + 1 < kPoses; ++pose) star += quarterTurn(kPoses - 1, pose);
  const fs::path graph = folder_.write("graph.g2o", star);
  for (const std::string policy : {"fluid", "every"}) {
    ASSERT_EQ(solve(graph, "--policy " + policy, "timeout 60 "), 0);
    const json result = json::parse(folder_.read("solve.json"));
    EXPECT_EQ(result["poses"], kPoses);
    EXPECT_NEAR(result["chi2"], 0, kTol);
  }
}

TEST_F(Solve, WritesWhatIsSolvedWhenASignalEndsIt) {
  constexpr int kPoses = 20'000, kLongSteps = 100;
  std::string drive;
  for (int pose = 1; pose < kPoses; ++pose) {
    drive += ahead(pose - 1, pose);
    if (pose % kLongSteps == 0) drive += ahead(pose - kLongSteps, pose);
  }
  const fs::path graph = folder_.write("graph.g2o", drive);
  EXPECT_EQ(solve(graph, "--policy every --every 2", "timeout --preserve-status -s TERM 1 "), 143);
  const json result = json::parse(folder_.read("solve.json"));
  EXPECT_EQ(result["complete"], false);
  EXPECT_GT(result["poses"], 1);
  EXPECT_LT(result["poses"], kPoses);
  EXPECT_EQ(readPoseGraph(folder_ / "out.g2o").vertices.size(), result["poses"]);
}

TEST_F(Solve, ErrorsSayWhatToMend) {
  EXPECT_THAT(errorOf("EDGE_SE2 0 1 1 0 0 1 0 0 1 0\n"),
              AllOf(HasSubstr("graph.g2o, line 1"), HasSubstr("give it 11")));
  EXPECT_THAT(errorOf(quarterTurn(0, 1) + ahead(1, 2)), AllOf(HasSubstr("line 2"), HasSubstr("two files")));
  EXPECT_THAT(errorOf(""), HasSubstr("no pose and no edge"));
  EXPECT_EQ(solve(folder_ / "absent.g2o"), 3);
  EXPECT_THAT(folder_.read("stderr"), HasSubstr("absent.g2o"));
  const fs::path good = folder_.write("good.g2o", quarterTurn(0, 1));
  EXPECT_EQ(solve(good, "--policy sometimes"), 2);
  EXPECT_EQ(solve(good, "--every 5"), 2);
  EXPECT_EQ(solve(good, "--json " + (folder_ / "absent/solve.json").string()), 2) << "--json twice";
  EXPECT_EQ(WEXITSTATUS(std::system(
                (std::string(MOTORCADE_PROGRAM " solve ") + good.string() + " --out /dev/null/out.g2o >/dev/null 2>&1")
                    .c_str())),
            4);
}

TEST_F(Solve, PublicGraphsReachTheirBatchOptimum) {
  const std::vector<std::pair<std::string, double>> optima{
      {"manhattan", 3549.04}, {"sphere2500", 1351.36}, {"parking-garage", 1.2684}};
  for (const auto& [name, chi2] : optima) {
    if (!fs::exists(kGraphs / (name + ".g2o"))) GTEST_SKIP() << kGraphs / name << ".g2o is not there";
    const json result = solvedFile(kGraphs / (name + ".g2o"), "--batch");
    EXPECT_NEAR(result["chi2"], chi2, 1e-4 * chi2) << name;  // the digits known
    EXPECT_THAT(result["problems"], IsEmpty()) << name;
  }
}

TEST_F(Solve, APublicGraphIsSmoothedPoseByPose) {
  const fs::path manhattan = kGraphs / "manhattan.g2o";
  if (!fs::exists(manhattan)) GTEST_SKIP() << manhattan << " is not there";
  const json result = solvedFile(manhattan);
  EXPECT_EQ(result["updates"], 3500);
  EXPECT_LT(result["chi2"], 1.01 * 3549.04);
  EXPECT_THAT(result["problems"], IsEmpty());
}

TEST(PoseGraphFeed, KnowsVariablesPosesAndChi2AfterEachUpdate) {
  test::TemporaryFolder folder;
  const PoseGraph graph =
      readPoseGraph(folder.write("g.g2o", quarterTurn(3, 5) + quarterTurn(5, 9) + "EDGE_SE2 3 9 1 2 3" + kUnit3));
  PoseGraphFeed feed(graph, {});
  EXPECT_EQ(feed.updateCount(), 3U);
  feed.next();
  EXPECT_FALSE(feed.variableOf(5).has_value());
  const auto second = feed.next();
  EXPECT_EQ(second.poses, 1);
  EXPECT_EQ(second.edges, 1);
  EXPECT_NEAR(feed.chi2(), 0, kTol);
  const auto third = feed.next();
  EXPECT_EQ(third.edges, 2);
  EXPECT_TRUE(feed.atEnd());
  EXPECT_GT(feed.chi2(), 0.1);
  for (const std::int64_t id : graph.poses) EXPECT_EQ(feed.poseOf(feed.variableOf(id).value()), id);
  EXPECT_FALSE(feed.variableOf(4).has_value());
  EXPECT_EQ(feed.index().id(feed.gauge().parts()[feed.gauge().mainPart()].held.front()), 3);
}

}  // namespace
}  // namespace motorcade
