#include "io/results/pose_graph.hpp"

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "tests/io/temporary_folder.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::IsNear;
using test::IsNearPose;
using test::messageOf;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Kind = PoseGraph::Problem::Kind;

class PoseGraphFile : public testing::Test {
 protected:
  PoseGraph read(std::string_view content) { return readPoseGraph(folder_.write("graph.g2o", content)); }
  std::string errorOf(std::string_view content) {
    return messageOf<InputError>([&] { read(content); });
  }
  /// The kinds of problems, in the order of the file.
  std::vector<Kind> problemsOf(std::string_view content) {
    std::vector<Kind> kinds;
    for (const auto& problem : read(content).problems) kinds.push_back(problem.kind);
    return kinds;
  }
  test::TemporaryFolder folder_;
};

const std::string kUnit3 = " 1 0 0 1 0 1\n";
const std::string kUnit6 = " 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n";

TEST_F(PoseGraphFile, TellsPosesMeasurementsAndInformationInThePlane) {
  const PoseGraph graph =
      read("# a comment\n\nVERTEX_SE2 4 1 2 0.5\r\n\tEDGE_SE2 9 4 1e0 -2 +.25 1 2 3 10 5 20 # behind a line\n");
  EXPECT_TRUE(graph.planar);
  EXPECT_THAT(graph.poses, ElementsAre(4, 9));
  ASSERT_EQ(graph.vertices.size(), 1U);
  EXPECT_EQ(graph.vertices[0].id, 4);
  EXPECT_EQ(std::get<SE2>(graph.vertices[0].pose).angle_rad(), 0.5);
  ASSERT_EQ(graph.edges.size(), 1U);
  EXPECT_EQ(graph.edges[0].from, 9);
  EXPECT_EQ(graph.edges[0].line, 4);
  EXPECT_EQ(std::get<SE2>(graph.edges[0].measured).translation(), Eigen::Vector2d(1, -2));
  EXPECT_EQ(graph.edges[0].information, (Eigen::Matrix3d() << 1, 2, 3, 2, 10, 5, 3, 5, 20).finished());
  EXPECT_THAT(graph.problems, IsEmpty());
}

TEST_F(PoseGraphFile, TakesQuaternionsAsXyzwOfAnyLength) {
  const PoseGraph graph = read("EDGE_SE3:QUAT 0 1 1 2 3 0 0 -2 -2 2 0 0 0 0 1 3 0 0 0 0 4 0 0 0 5 0 0 6 0 7");
  const SE3 quarter_turn(expSO3({0, 0, 1.5707963267948966}), {1, 2, 3});
  EXPECT_THAT(std::get<SE3>(graph.edges.at(0).measured), IsNearPose(quarter_turn, 1e-12));
  EXPECT_EQ(graph.edges[0].information(0, 5), 1);
  EXPECT_EQ(graph.edges[0].information(5, 0), 1);
  EXPECT_EQ(graph.edges[0].information(3, 3), 5);
  EXPECT_THAT(graph.vertices, IsEmpty());
  EXPECT_THAT(graph.poses, ElementsAre(0, 1));
}

TEST_F(PoseGraphFile, KeepsFramesAndFixedPoses) {
  const PoseGraph graph = read("FIX 0 3\nFRAME 1\nEDGE_SE2 0 1 1 0 0" + kUnit3 + "FRAME 5\n");
  EXPECT_THAT(graph.fixed, ElementsAre(0, 3));
  EXPECT_THAT(graph.frame_ends, ElementsAre(1, 5));
}

TEST_F(PoseGraphFile, ErrorsNameFileLineAndHowToFixIt) {
  EXPECT_THAT(errorOf("\nEDGE_SE2 0 1 1 0 0 1 0 0 1 0\n"),
              AllOf(HasSubstr("graph.g2o, line 2"), HasSubstr("give it 11")));
  EXPECT_THAT(errorOf("EDGE_SE2 0 1 1 0 0 1 0 0 1 0 1 8\n"), AllOf(HasSubstr("line 1"), HasSubstr("followed by 12")));
  EXPECT_THAT(errorOf("VERTEX_SE3:QUAT 0 0 0 0 0 0 1\n"), HasSubstr("give it 8"));
  EXPECT_THAT(errorOf("EDGE_SE2 0 1 1 zero 0" + kUnit3),
              AllOf(HasSubstr("line 1"), HasSubstr("'zero'"), HasSubstr("decimal number")));
  EXPECT_THAT(errorOf("EDGE_SE2 0 1 1 0x 0" + kUnit3), HasSubstr("'0x'"));
  EXPECT_THAT(errorOf("EDGE_SE2 0 1.5 1 0 0" + kUnit3), AllOf(HasSubstr("'1.5'"), HasSubstr("whole numbers")));
  EXPECT_THAT(errorOf("EDGE_SE2 0 -1 1 0 0" + kUnit3), AllOf(HasSubstr("-1 is negative"), HasSubstr("from 0")));
  EXPECT_THAT(errorOf("EDGE_SE2 0 99999999999999999999 1 0 0" + kUnit3), HasSubstr("whole numbers"));
  EXPECT_THAT(errorOf("EDGE_XY 0 1 1 0\n"), AllOf(HasSubstr("unknown tag 'EDGE_XY'"), HasSubstr("EDGE_SE2")));
  EXPECT_THAT(errorOf("EDGE_SE2 0 1 1 0 0\n"), AllOf(HasSubstr("has no information"), HasSubstr(" 1 0 0 1 0 1")));
  EXPECT_THAT(errorOf("EDGE_SE2 0 1 1,5 0 0" + kUnit3), AllOf(HasSubstr("'1,5'"), HasSubstr("s/,/./g")));
  EXPECT_THAT(errorOf("TUTORIAL_VERTEX_SE2 0 1 2 3\n"), HasSubstr("s/^TUTORIAL_//"));
  EXPECT_THAT(errorOf("VERTEX_SE3 : QUAT 0 1 2 3 0 0 0 1\n"), HasSubstr("write VERTEX_SE3:QUAT, without blanks"));
  EXPECT_THAT(errorOf("EDGE_SE3_PRIOR 1 0 1 2 3 0 0 0 1\n"), HasSubstr("hold a pose with FIX"));
  for (const char* tag : {"VERTEX_XY", "EDGE_SE2_XY", "VERTEX_TRACKXYZ", "EDGE_SE3_TRACKXYZ", "VERTEX_CAM"})
    EXPECT_THAT(errorOf(std::string(tag) + " 0 1 2\n"), AllOf(HasSubstr("line 1"), HasSubstr("are not solved"))) << tag;
  EXPECT_THAT(errorOf("EDGE2 0 1 1 0 0 1 0 1 1 0 0\n"), HasSubstr("TORO"));
  EXPECT_THAT(errorOf("EDGE_SWITCHABLE 0 1\n"), HasSubstr("write it as one of VERTEX_SE2"));
  EXPECT_THAT(errorOf("EDGE_SE2 0 1 1 0 0" + kUnit3 + "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\n"),
              AllOf(HasSubstr("line 2"), HasSubstr("two files")));
  EXPECT_THAT(errorOf("EDGE_SE3:QUAT 0 1 0 0 0 0 0 0 0" + kUnit6),
              AllOf(HasSubstr("line 1"), HasSubstr("quaternion is zero")));
  EXPECT_THAT(errorOf("FRAME\n"), HasSubstr("give it the id of the last pose"));
  EXPECT_THAT(errorOf("FIX zero\n"), HasSubstr("'zero'"));
  EXPECT_THAT(errorOf("# nothing\n"), HasSubstr("no pose and no edge"));
  EXPECT_THAT(messageOf<InputError>([&] { readPoseGraph(folder_ / "absent.g2o"); }), HasSubstr("absent.g2o"));
}

TEST_F(PoseGraphFile, AFileThatIsNoTextDoesNotReachTheTerminal) {
  EXPECT_THAT(errorOf(std::string("\x1b[31m\x01", 6) + std::string(3000, 'x')), testing::SizeIs(testing::Lt(400U)));
  EXPECT_THAT(errorOf("\x1b[31m"), testing::Not(HasSubstr("\x1b")));
}

TEST_F(PoseGraphFile, EdgesThatCannotCountAreLeftOutAndNamed) {
  const std::string good = "EDGE_SE2 0 1 1 0 0" + kUnit3;
  for (const char* bad : {"nan", "-inf", "1e999", "1e60"}) {
    const PoseGraph graph = read(good + "EDGE_SE2 3 17 1 " + bad + " 0" + kUnit3);
    EXPECT_EQ(graph.edges.size(), 1U);
    ASSERT_EQ(graph.problems.size(), 1U) << bad;
    EXPECT_EQ(graph.problems[0].kind, Kind::kNotFinite);
    EXPECT_EQ(graph.problems[0].line, 2);
    EXPECT_EQ(graph.problems[0].name, "edge from pose 3 to pose 17");
    EXPECT_THAT(graph.problems[0].detail, HasSubstr("line 2"));
    EXPECT_THAT(graph.poses, ElementsAre(0, 1, 3, 17)) << "a pose does not vanish with its edge";
  }
  EXPECT_THAT(problemsOf(good + "EDGE_SE2 1 2 1 0 0 1 0 0 nan 0 1\n"), ElementsAre(Kind::kNotFinite));
  EXPECT_THAT(problemsOf(good + "EDGE_SE2 1 2 1 0 0 1 2 0 1 0 1\n"), ElementsAre(Kind::kNotPositiveDefinite));
  EXPECT_THAT(problemsOf(good + "EDGE_SE2 1 2 1 0 0 1 0 0 1 0 -1e-3\n"), ElementsAre(Kind::kNotPositiveDefinite));
  EXPECT_THAT(problemsOf(good + "EDGE_SE2 1 2 1 0 0 1e14 0 0 1e14 0 -1\n"), ElementsAre(Kind::kNotPositiveDefinite));
  EXPECT_THAT(problemsOf(good + "EDGE_SE2 1 2 1 0 0 1 0 2 1 0 0\n"), ElementsAre(Kind::kNotPositiveDefinite));
  EXPECT_THAT(problemsOf(good + "EDGE_SE2 1 1 1 0 0" + kUnit3), ElementsAre(Kind::kSelfEdge));
}

TEST_F(PoseGraphFile, EdgesThatLeaveDirectionsOpenCount) {
  for (const char* information : {"1 0 0 1 0 0", "0 0 0 0 0 5", "0 0 0 0 0 0", "1 2 3 4 6 9", "1e12 0 0 0 0 1e-6"}) {
    const PoseGraph graph = read(std::string("EDGE_SE2 0 1 1 0 0 ") + information + "\nEDGE_SE2 1 2 1 0 0" + kUnit3);
    EXPECT_THAT(graph.problems, IsEmpty()) << information;
    ASSERT_EQ(graph.edges.size(), 2U);
    EXPECT_FALSE(graph.edges[0].definite) << information;
    EXPECT_TRUE(graph.edges[1].definite);
  }
}

/// g2o writes such lines into graphs in space, for edges with landmarks.
TEST_F(PoseGraphFile, ParametersArePassedOver) {
  const PoseGraph graph = read("PARAMS_SE3OFFSET 0 0 0 0 0 0 0 1\nEDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1" + kUnit6);
  EXPECT_EQ(graph.edges.size(), 1U);
}

TEST_F(PoseGraphFile, NumbersTooSmallForDoubleAreZero) {
  EXPECT_EQ(std::get<SE2>(read("EDGE_SE2 0 1 1e-999 0 0" + kUnit3).edges.at(0).measured).translation().x(), 0);
}

TEST_F(PoseGraphFile, TheFirstOfDuplicateVerticesIsKept) {
  const PoseGraph graph = read("VERTEX_SE2 7 1 0 0\nVERTEX_SE2 7 2 0 0\n");
  ASSERT_EQ(graph.vertices.size(), 1U);
  EXPECT_EQ(std::get<SE2>(graph.vertices[0].pose).translation().x(), 1);
  ASSERT_EQ(graph.problems.size(), 1U);
  EXPECT_EQ(graph.problems[0].kind, Kind::kDuplicateVertex);
  EXPECT_EQ(graph.problems[0].name, "pose 7");
  EXPECT_THAT(graph.problems[0].detail, AllOf(HasSubstr("line 2"), HasSubstr("line 1 is kept")));
}

TEST_F(PoseGraphFile, ARepeatedEdgeCountsTwiceAndIsNamed) {
  const std::string edge = "EDGE_SE2 0 1 1 0 0" + kUnit3;
  const PoseGraph graph = read(edge + "EDGE_SE2 0 1 1 0 0.5" + kUnit3 + edge);
  EXPECT_EQ(graph.edges.size(), 3U);
  ASSERT_EQ(graph.problems.size(), 1U);
  EXPECT_EQ(graph.problems[0].kind, Kind::kRepeatedEdge);
  EXPECT_THAT(graph.problems[0].detail, AllOf(HasSubstr("line 3"), HasSubstr("line 1")));
}

TEST_F(PoseGraphFile, WhatIsWrittenReadsBackTheSame) {
  const std::string in_space =
      "VERTEX_SE3:QUAT 3 0.1 -1e-9 12345.678 0.1 0.2 -0.3 0.9\nEDGE_SE3:QUAT 3 5 0.1 0.2 0.3 0.5 -0.5 0.5 -0.5" +
      kUnit6;
  const std::string in_plane = "VERTEX_SE2 0 0.1 0.2 3\nFIX 0\nEDGE_SE2 0 1 0.1 0.2 -3 3 0.1 0.2 3 0.3 3\nFRAME 1\n";
  for (const std::string& text : {in_space, in_plane}) {
    const PoseGraph graph = read(text);
    writePoseGraph(folder_ / "written.g2o", graph);
    const PoseGraph again = readPoseGraph(folder_ / "written.g2o");
    EXPECT_EQ(again.planar, graph.planar);
    EXPECT_EQ(again.poses, graph.poses);
    EXPECT_EQ(again.fixed, graph.fixed);
    EXPECT_EQ(again.frame_ends, graph.frame_ends);
    EXPECT_EQ(again.edges.at(0).information, graph.edges.at(0).information);
    std::visit(
        [&](const auto& pose) {
          using Pose = std::decay_t<decltype(pose)>;
          EXPECT_THAT(std::get<Pose>(again.vertices.at(0).pose), IsNearPose(pose, 1e-15));
          EXPECT_THAT(std::get<Pose>(again.edges.at(0).measured),
                      IsNearPose(std::get<Pose>(graph.edges.at(0).measured), 1e-15));
        },
        graph.vertices.at(0).pose);
  }
  EXPECT_THROW(writePoseGraph(folder_ / "absent/graph.g2o", read(in_plane)), OutputError);
}

}  // namespace
}  // namespace motorcade
