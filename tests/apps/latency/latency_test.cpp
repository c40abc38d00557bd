#include <numeric>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "apps/latency/latency_report.hpp"
#include "io/files/errors.hpp"
#include "tests/io/temporary_folder.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using testing::ElementsAre;
using testing::Field;
using testing::HasSubstr;

double& workOf(FrameRow& row, Stage stage) { return row.stages[static_cast<std::size_t>(stage)].work_ms; }
double& waitOf(FrameRow& row, Stage stage) { return row.stages[static_cast<std::size_t>(stage)].wait_ms; }

double sumOf(const std::vector<WayPart>& way) {
  return std::accumulate(way.begin(), way.end(), 0.0, [](double sum, const WayPart& part) { return sum + part.ms; });
}

/// A frame in which every stage takes a millisecond.
FrameRow frame(int number) {
  FrameRow row;
  row.head.frame = {number};
  row.has_waits = true;
  for (auto& stage : row.stages) stage.work_ms = stage.cpu_ms = 1;
  row.latency_ms = sumOf(longestWay(row));
  return row;
}

FrameRow slowFrame(int number, double flow_ms, double tracking_wait_ms) {
  FrameRow row = frame(number);
  workOf(row, Stage::kOpticalFlow) += flow_ms;
  waitOf(row, Stage::kTracking) += tracking_wait_ms;
  row.latency_ms = sumOf(longestWay(row));
  return row;
}

TEST(Percentiles, AreByNearestRank) {
  std::vector<double> values(200);
  std::iota(values.rbegin(), values.rend(), 1);
  const Percentiles of = percentilesOf(values);
  EXPECT_EQ(of.p50, 100);
  EXPECT_EQ(of.p95, 190);
  EXPECT_EQ(of.p99, 198);
  EXPECT_EQ(of.max, 200);
  EXPECT_EQ(percentilesOf({7}).p50, 7);
  EXPECT_EQ(percentilesOf({}).max, 0);
}

TEST(Processing, IsTheWorkWithoutAnyWaiting) {
  FrameRow row = slowFrame(0, 3, 50);
  row.entry_wait_ms = 400;
  EXPECT_DOUBLE_EQ(processing_ms(row), 9)
      << "six stages of a millisecond and a flow of four, beside it stereo matching";
  workOf(row, Stage::kStereoMatching) = 6;
  EXPECT_DOUBLE_EQ(processing_ms(row), 11);
}

TEST(LongestWay, LeadsOverTheBranchThatEndedLast) {
  FrameRow row = frame(0);
  waitOf(row, Stage::kStereoMatching) = 4;
  EXPECT_THAT(longestWay(row), testing::Contains(Field(&WayPart::name, "stereo matching")));
  workOf(row, Stage::kOpticalFlow) = 6;
  EXPECT_THAT(longestWay(row), testing::Contains(Field(&WayPart::name, "optical flow")));
  EXPECT_DOUBLE_EQ(sumOf(longestWay(row)), 1 + 6 + 4);  // prepare, flow and the four stages behind it
}

TEST(LatencyReport, TellsWhereTheSlowestFramesLostTheirTime) {
  std::vector<FrameRow> rows;
  for (int i = 0; i < 20; ++i) rows.push_back(frame(i));
  rows[4] = slowFrame(4, 3, 8);
  rows[11] = slowFrame(11, 5, 0);
  rows[12].head.status = FrameStatus::kDropped;
  rows[13].head.status = FrameStatus::kLost;
  const LatencyReport report = latencyReport(rows, 2);
  EXPECT_EQ(report.frames, 19u);
  EXPECT_EQ(report.dropped, 1u);
  EXPECT_EQ(report.lost, 1u);
  ASSERT_EQ(report.slowest.size(), 2u);
  EXPECT_EQ(report.slowest[0].row.head.frame.value, 4);
  EXPECT_THAT(report.slowest[0].above_median,
              ElementsAre(Field(&WayPart::name, "waiting for tracking"), Field(&WayPart::name, "optical flow")));
  EXPECT_DOUBLE_EQ(report.slowest[0].above_median[0].ms, 8);
  EXPECT_EQ(report.slowest[1].row.head.frame.value, 11);
}

TEST(LatencyTable, FitsAHundredColumnsAndNamesEveryStage) {
  std::vector<FrameRow> rows{frame(0), slowFrame(1, 3000, 4000), frame(2)};
  const std::string table = latencyTable(latencyReport(rows));
  for (std::size_t stage = 0; stage < kStageCount; ++stage)
    EXPECT_THAT(table, HasSubstr(nameOf(static_cast<Stage>(stage))));
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 100u) << line;
  rows.front().has_waits = rows[1].has_waits = rows[2].has_waits = false;
  EXPECT_THAT(latencyTable(latencyReport(rows)), HasSubstr("earlier version"));
}

TEST(LatencyCommand, WritesTheSameAsJsonAndRefusesWhatIsNoRun) {
  const test::TemporaryFolder folder;
  EXPECT_THAT(test::messageOf<InputError>([&] { runLatency({.run = folder / "none"}); }), HasSubstr("frames.csv"));
  FrameTiming timing;
  timing.due = SteadyTime(std::chrono::milliseconds(1));
  timing.published = timing.due + std::chrono::milliseconds(12);
  folder.write("run/frames.csv", framesHeader() + "\n" + frameLine(timing) + "\n");
  EXPECT_EQ(runLatency({.run = folder / "run", .json = folder / "latency.json"}), 0);
  const auto json = nlohmann::json::parse(folder.read("latency.json"));
  EXPECT_DOUBLE_EQ(json["latency_ms"]["p99"], 12);
  EXPECT_EQ(json["slowest"].size(), 1u);
}

}  // namespace
}  // namespace motorcade
