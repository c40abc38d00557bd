#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/merge/published_tables.hpp"

namespace motorcade {
namespace {

using testing::ElementsAre;
using Row = std::vector<std::string>;

/// Results of one drive by hand.
ResultGroup groupOf(const std::string& drive, const std::string& set, double ate_m, double t_percent = kNoValue,
                    double segments = kNoValue) {
  MergedTask task{.task = {.drive = drive, .set = set}, .outcome = TaskOutcome::kDone};
  task.values.assign(allMeasures().size(), kNoValue);
  task.values[measureIndex("frames")] = 100;
  task.values[measureIndex("camera_ate_m")] = ate_m;
  task.values[measureIndex("camera_kitti_t_percent")] = t_percent;
  task.values[measureIndex("camera_kitti_segments")] = segments;
  ResultGroup group(drive, set);
  group.add(task);
  group.finish();
  return group;
}

PublishedFigure figure(const std::string& method, const std::string& drive, double value,
                       const std::string& measure = "camera_ate_m") {
  return {.method = method, .measure = measure, .drives = {drive}, .value = value, .source = "paper of " + method};
}

TEST(PublishedTables, StandBesideTheDrivesThatBothHave) {
  const std::vector groups{groupOf("00", "default", 0.5), groupOf("01", "default", 0.25), groupOf("02", "default", 1)};
  const std::vector figures{figure("A", "00", 0.75), figure("B", "00", 2), figure("B", "01", 3), figure("B", "07", 9)};
  const auto tables = publishedTables(groups, figures);
  ASSERT_EQ(tables.size(), 1U);
  EXPECT_EQ(tables[0].title, "Beside published figures: camera_ate_m");
  EXPECT_THAT(tables[0].heads, ElementsAre("drive", "here", "A", "B"));
  EXPECT_THAT(tables[0].rows, ElementsAre(Row{"00", "0.5", "0.75", "2"}, Row{"01", "0.25", "-", "3"}));
  // The mean of one drive is no mean.
  EXPECT_THAT(publishedMeans(groups, figures).rows, ElementsAre(Row{"camera_ate_m", "B", "2", "0.375", "2.5"}));
  EXPECT_THAT(publishedSources(groups, figures).rows,
              ElementsAre(Row{"A", "camera_ate_m", "paper of A", ""}, Row{"B", "camera_ate_m", "paper of B", ""}));
}

TEST(PublishedTables, MeasuresOfOneSourceShareALine) {
  const std::vector groups{groupOf("00", "default", 0.5, 1, 10)};
  PublishedFigure percent = figure("A", "00", 0.9, "camera_kitti_t_percent");
  EXPECT_THAT(publishedSources(groups, {figure("A", "00", 1), percent}).rows,
              ElementsAre(Row{"A", "camera_ate_m, camera_kitti_t_percent", "paper of A", ""}));
}

TEST(PublishedTables, NameTheSetWhereThereAreSeveral) {
  const std::vector groups{groupOf("00", "x", 0.5), groupOf("00", "y", 0.625)};
  const auto tables = publishedTables(groups, {figure("A", "00", 1)});
  EXPECT_THAT(tables.at(0).rows, ElementsAre(Row{"00", "x", "0.5", "1"}, Row{"00", "y", "0.625", "1"}));
}

TEST(PublishedTables, AMeanIsComparedWhereAllOfItsDrivesAreThere) {
  PublishedFigure mean = figure("C", "00", 0.8, "camera_kitti_t_percent");
  mean.drives = {"00", "01"};
  // The benchmark's means are over segments: (3 * 1 + 1 * 2) / 4.
  const std::vector both{groupOf("00", "default", 1, 1, 30), groupOf("01", "default", 1, 2, 10)};
  EXPECT_THAT(publishedMeans(both, {mean}).rows, ElementsAre(Row{"camera_kitti_t_percent", "C", "2", "1.25", "0.8"}));
  const std::vector one{groupOf("00", "default", 1, 1, 30)};
  EXPECT_THAT(publishedMeans(one, {mean}).rows, ElementsAre(Row{"camera_kitti_t_percent", "C", "1 of 2", "-", "0.8"}));
  EXPECT_TRUE(publishedTables(both, {mean}).empty());
}

TEST(PublishedTables, RunsOfOtherFramesAreNotCompared) {
  const std::vector groups{groupOf("00", "default", 0.5), groupOf("01", "default", 0.25)};
  PublishedFigure of_most = figure("A", "00", 0.75), of_a_part = figure("A", "01", 0.5);
  of_most.frames = {99};
  of_a_part.frames = {447};
  EXPECT_THAT(publishedTables(groups, {of_most, of_a_part}).at(0).rows, ElementsAre(Row{"00", "0.5", "0.75"}));
  EXPECT_THAT(otherFrames(groups, {of_most, of_a_part}).rows, ElementsAre(Row{"01", "default", "100", "447"}));
  EXPECT_TRUE(publishedMeans(groups, {of_most, of_a_part}).rows.empty());
  EXPECT_TRUE(publishedTables(groups, {of_a_part}).empty());
  EXPECT_TRUE(publishedSources(groups, {of_a_part}).rows.empty());
}

TEST(PublishedTables, AreEmptyWithoutAnyOfTheDrives) {
  const std::vector groups{groupOf("05", "default", 1)};
  const std::vector figures{figure("A", "00", 0.75)};
  EXPECT_TRUE(publishedTables(groups, figures).empty());
  EXPECT_TRUE(publishedMeans(groups, figures).rows.empty());
  EXPECT_TRUE(publishedSources(groups, figures).rows.empty());
}

TEST(PublishedTables, FiguresOfOneMethodAndDriveShareARow) {
  PublishedFigure rotation = figure("A", "00", 0.04, "camera_rpe_r_rmse_deg");
  rotation.source = "another table";
  const auto rows = publishedRows({figure("A", "00", 0.75), rotation, figure("A", "01", 1)});
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].values[measureIndex("camera_ate_m")], 0.75);
  EXPECT_EQ(rows[0].values[measureIndex("camera_rpe_r_rmse_deg")], 0.04);
  EXPECT_EQ(rows[0].source, "paper of A; another table");
}

TEST(PublishedTables, MeasuresThatNoResultHasAreLeftOut) {
  const auto known = comparableFigures({figure("A", "00", 1), figure("A", "00", 1, "camera_luck_m")});
  ASSERT_EQ(known.size(), 1U);
  EXPECT_EQ(known[0].measure, "camera_ate_m");
}

/// The project's own figures.
TEST(PublishedFigures, AreOfMeasuresThatResultsHave) {
  for (const char* const dataset : {"kitti_tracking", "kitti_odometry"}) {
    const auto figures = readPublishedFigures(MOTORCADE_SOURCE_DIR "/perf/datasets/published.toml", dataset);
    EXPECT_FALSE(figures.empty()) << dataset;
    EXPECT_EQ(comparableFigures(figures).size(), figures.size()) << dataset;
  }
}

}  // namespace
}  // namespace motorcade
