#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "apps/merge/batch_comparison.hpp"
#include "apps/merge/measures.hpp"
#include "apps/merge/merged_files.hpp"
#include "apps/tasks/batch_folder.hpp"
#include "apps/tasks/task_record.hpp"
#include "io/files/errors.hpp"
#include "tests/apps/merge/merged_batch_by_hand.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;
using test::MergeBatch;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(NumberText, HasNoDigitsThatSayNothing) {
  EXPECT_EQ(numberText(0.4004, 3), "0.4");
  EXPECT_EQ(numberText(-0.0001, 3), "0");
  EXPECT_EQ(numberText(kNoValue, 2), "-");
  EXPECT_EQ(percentText(0.9376, 1), "93.8 %");
  EXPECT_EQ(percentText(kNoValue, 1), "-");
}

TEST(RelativeChange, IsTheSameInBothDirectionsAndKnowsZero) {
  EXPECT_EQ(relativeChange(1, 3), 1);
  EXPECT_EQ(relativeChange(3, 1), -1);
  EXPECT_EQ(relativeChange(0, 2), 2);
  EXPECT_EQ(relativeChange(0, 0), 0);
}

TEST_F(MergeBatch, EachTaskIsARowOfTheTableWithAllMeasures) {
  write("a", {{.drive = "x", .ate_m = 0.25}, {.drive = "y", .ate_m = 0.5, .labels = false}});
  std::istringstream csv(merged("results.csv"));
  std::string head, x, y;
  std::getline(csv, head);
  std::getline(csv, x);
  std::getline(csv, y);
  EXPECT_THAT(head, HasSubstr("task,drive,set,seed,repetition,status,failure,frames,camera_ate_m,"));
  EXPECT_THAT(x, testing::StartsWith("x.default,x,default,,1,done,,50,0.25,0.5,"));
  EXPECT_THAT(y, testing::StartsWith("y.default,y,default,,1,done,,50,0.5,0.5,"));
  EXPECT_EQ(std::ranges::count(head, ','), std::ranges::count(x, ','));
}

TEST_F(MergeBatch, TheOverviewIsTheReadmesTable) {
  write("a", {{.drive = "x", .ate_m = 0.2515}, {.drive = "y", .ate_m = 0.5, .labels = false}});
  EXPECT_THAT(merged("results.md"),
              AllOf(HasSubstr("| x | 0.252 | - | 1.23 | - | 0.503 | 0.625 | 90 % (9/10) | 1 of 12 |\n"),
                    HasSubstr("| y | 0.5 | - | 1.23 (10 to 80 m) | - | - | - | - | - |\n")));
}

TEST_F(MergeBatch, PublishedFormsOfMeasuresAreColumns) {
  write("a", {{.drive = "x", .ate_m = 0.25}});
  const auto json = nlohmann::json::parse(merged("results.json"));
  const auto& measures = json["tasks"][0]["measures"];
  EXPECT_EQ(measures["camera_kitti_t_percent"], 1.234);
  EXPECT_EQ(measures["camera_kitti_r_deg_per_m"], 0.00321);
  EXPECT_EQ(measures["camera_kitti_segments"], 12);
  EXPECT_EQ(measures["camera_kitti_shortest_m"], 100);
  EXPECT_EQ(measures["online_camera_kitti_t_percent"], 2.5);
  EXPECT_EQ(measures["me_t_object_rms_m"], 0.625);
  EXPECT_EQ(measures["online_me_r_object_rms_deg"], 0.5);
  EXPECT_EQ(measures["me_t_followed_p95_m"], 0.75);
  EXPECT_EQ(measures["me_t_followed_max_m"], 1.5);
  EXPECT_TRUE(measures["me_r_followed_max_deg"].is_null());
  for (const std::string_view name : {"camera_kitti_t_percent", "me_t_object_rms_m", "online_me_r_followed_max_deg"})
    EXPECT_EQ(allMeasures()[measureIndex(name)].better, Better::kLower) << name;
  EXPECT_THAT(merged("results.md"),
              AllOf(HasSubstr("| 1.234 / 2.5 | 0.00321 / 0.004 |"),
                    HasSubstr("| x | 0.625 / 0.875 | - / - | - / - | 0.75 / - | 1.5 / - | 0.25 / 0.5 |")));
}

TEST_F(MergeBatch, SeedsCountOnceHoweverOftenTheyWereRun) {
  write("a", {{.drive = "x", .ate_m = 1, .seed = 1},
              {.drive = "x", .ate_m = 2, .seed = 1, .repetition = 2},
              {.drive = "x", .ate_m = 4.5, .seed = 2}});
  const auto json = nlohmann::json::parse(merged("results.json"));
  const auto& ate = json["groups"][0]["measures"]["camera_ate_m"];
  EXPECT_EQ(ate["mean"], 3.0);  // of 1.5 and 4.5
  EXPECT_EQ(ate["seeds"], 2);
  EXPECT_THAT(merged("results.md"), HasSubstr("(18/20)"));  // counts are summed over seeds
}

TEST_F(MergeBatch, SetsStandSideBySideWhereThereAreSeveral) {
  write("a", {{.drive = "x", .set = "p", .ate_m = 1}, {.drive = "x", .set = "q", .ate_m = 2}});
  EXPECT_THAT(merged("results.md"), AllOf(HasSubstr("| x | p | 1 |"), HasSubstr("| x | q | 2 |")));
}

TEST_F(MergeBatch, WhatHasNoResultIsNamedWithItsReasonEverywhere) {
  const Task failed{.name = "bad.default", .drive = "bad", .set = "default", .fingerprint = "f"};
  const Task missing{.name = "late.default", .drive = "late", .set = "default", .fingerprint = "f"};
  write("a", {{.drive = "x", .ate_m = 1}}, {failed, missing});
  const fs::path place = BatchFolder(root_ / "a").failure("bad.default");
  fs::create_directories(place);
  TaskRecord record{.task = "bad.default", .fingerprint = "f"};
  record.failure = TaskFailure{.step = "run", .message = "run, it says, <failed>", .last_lines = {"error: no disk"}};
  writeTaskRecord(recordIn(place), record);
  EXPECT_THAT(merged("results.md"),
              AllOf(HasSubstr("# 3 tasks: 1 done, 1 failed, 1 missing"),
                    HasSubstr("| bad.default | failed | run, it says, <failed> | error: no disk |"),
                    HasSubstr("| late.default | missing |")));
  EXPECT_THAT(merged("results.csv"), AllOf(HasSubstr("bad.default,bad,default,,1,failed,\"run, it says, <failed>\""),
                                           HasSubstr("late.default,late,default,,1,missing,")));
  EXPECT_THAT(merged("report.html"), AllOf(HasSubstr("run, it says, &lt;failed&gt;"), HasSubstr("error: no disk")));
  EXPECT_EQ(nlohmann::json::parse(merged("results.json"))["tasks"][1]["failure"], "run, it says, <failed>");
}

TEST_F(MergeBatch, WhatWasPlannedAnewSinceDoesNotCount) {
  write("a", {{.drive = "x", .ate_m = 1}, {.drive = "y", .ate_m = 1}});
  const fs::path record = recordIn(BatchFolder(root_ / "a").result("y.default"));
  writeTaskRecord(record, {.task = "y.default", .fingerprint = "of another configuration"});
  EXPECT_THAT(merged("results.md"), HasSubstr("| y.default | missing |"));
}

TEST_F(MergeBatch, ADamagedResultIsNamedAndTheOthersAreMerged) {
  write("a", {{.drive = "x", .ate_m = 1}, {.drive = "y", .ate_m = 2}});
  std::ofstream(evaluationIn(BatchFolder(root_ / "a").result("x.default"))) << "{";
  const std::string text = merged("results.md");
  EXPECT_THAT(text, AllOf(HasSubstr("# 2 tasks: 1 done, 1 failed, 0 missing"),
                          HasSubstr("x.default/evaluation.json: is damaged"), HasSubstr("run the batch again"),
                          HasSubstr("| y | 2 |")));
}

TEST_F(MergeBatch, WithoutAnyResultItSaysWhatToDo) {
  EXPECT_THROW(runMerge({.batch = root_ / "nothing"}), InputError);
  write("a", {}, {{.name = "late.default", .drive = "late", .set = "default", .fingerprint = "f"}});
  EXPECT_THROW(runMerge({.batch = root_ / "a"}), InputError);
}

TEST_F(MergeBatch, TheWorstFramesComeFirst) {
  write("a", {{.drive = "x", .ate_m = 0.1}, {.drive = "y", .ate_m = 0.7}, {.drive = "z", .ate_m = 0.3}});
  const auto json = nlohmann::json::parse(merged("results.json"));
  std::vector<std::string> tasks;
  for (const auto& frame : json["worst_frames"]["camera_rpe_t_m"]) tasks.push_back(frame["task"]);
  EXPECT_THAT(tasks, testing::ElementsAre("y.default", "z.default", "x.default"));
  EXPECT_EQ(json["groups"][0]["worst_frames"]["camera_rpe_t_m"]["frame"], 7);
  EXPECT_THAT(merged("results.md"), HasSubstr("| x | 0.1 (frame 7 of x.default) | - | - |"));
}

TEST_F(MergeBatch, AgainstAnotherBatchWhatBecameWorseIsFound) {
  std::vector<Result> before, now;
  for (int i = 0; i < 12; ++i) {
    const std::string drive(1, static_cast<char>('a' + i));
    before.push_back({.drive = drive, .ate_m = 1.0 + 0.01 * i});
    now.push_back({.drive = drive, .set = "tried", .ate_m = 1.1 + 0.01 * i});
  }
  now[3].ate_m = 2;
  now.push_back({.drive = "new", .set = "tried", .ate_m = 1});
  write("a", now);
  write("b", before);
  const auto json = nlohmann::json::parse(merged("results.json", {.batch = root_ / "a", .against = root_ / "b"}));
  const auto& comparison = json["comparison"];
  for (const auto& measure : comparison["measures"]) {
    if (measure["measure"] == "camera_ate_m") {
      EXPECT_EQ(measure["verdict"], "worse");
      EXPECT_EQ(measure["worse"], 12);
      EXPECT_NEAR(measure["p"], 2 / 4096.0, 1e-9);  // all twelve signs alike
    }
    if (measure["measure"] == "cpu_per_frame_ms") {
      EXPECT_EQ(measure["verdict"], "the same");
    }
  }
  EXPECT_EQ(comparison["regressions"][0]["result"], "d");
  EXPECT_EQ(comparison["unpaired"][0], "new (not in the other batch)");
}

TEST_F(MergeBatch, ThePageColorsWhatBecameBetterAndWorseAndNamesItInWords) {
  std::vector<Result> before, worse, better;
  for (int i = 0; i < 12; ++i) {
    const std::string drive(1, static_cast<char>('a' + i));
    before.push_back({.drive = drive, .ate_m = 1 + 0.01 * i});
    worse.push_back({.drive = drive, .ate_m = 1.1 + 0.01 * i});
    better.push_back({.drive = drive, .ate_m = 0.9 + 0.01 * i});
  }
  write("before", before);
  write("worse", worse);
  write("better", better);
  const auto page = [&](const char* batch) {
    return merged("report.html", {.batch = root_ / batch, .against = root_ / "before"});
  };
  const std::string became_worse = page("worse"), became_better = page("better");
  EXPECT_THAT(became_worse, AllOf(HasSubstr("<td>camera ATE [m]</td><td class=\"worse\">worse</td>"),
                                  HasSubstr("<td class=\"number worse\">+9.")));
  EXPECT_THAT(became_better, AllOf(HasSubstr("<td>camera ATE [m]</td><td class=\"better\">better</td>"),
                                   HasSubstr("<td class=\"number better\">-1")));
  for (const Measure& measure : allMeasures())
    if (measure.name.find('_') != std::string_view::npos) {
      EXPECT_THAT(became_worse, Not(HasSubstr(std::string(measure.name)))) << "a raw key";
    }
}

TEST_F(MergeBatch, ThePageMarksTheBetterOfTwoSetsOfADrive) {
  write("a", {{.drive = "x", .set = "one", .ate_m = 0.5},
              {.drive = "x", .set = "two", .ate_m = 0.25},
              {.drive = "y", .set = "one", .ate_m = 0.5},
              {.drive = "y", .set = "two", .ate_m = 0.505}});
  const std::string page = merged("report.html");
  EXPECT_THAT(page, AllOf(HasSubstr("<td>x</td><td>one</td><td class=\"number worse\">0.5</td>"),
                          HasSubstr("<td>x</td><td>two</td><td class=\"number better\">0.25</td>"),
                          HasSubstr("<td>y</td><td>one</td><td class=\"number\">0.5</td>")))
      << "one percent is not worth telling";
}

TEST_F(MergeBatch, ABatchWithoutResultsIsNothingToCompareWith) {
  write("a", {{.drive = "x", .ate_m = 1}});
  write("b", {});
  EXPECT_THROW(runMerge({.batch = root_ / "a", .against = root_ / "b"}), InputError);
}

TEST_F(MergeBatch, FewPairsProveNothing) {
  write("a", {{.drive = "x", .ate_m = 2}});
  write("b", {{.drive = "x", .ate_m = 1}});
  const auto json = nlohmann::json::parse(merged("results.json", {.batch = root_ / "a", .against = root_ / "b"}));
  EXPECT_EQ(json["comparison"]["measures"][0]["verdict"], "1 pairs differ, too few to tell");
}

TEST_F(MergeBatch, GivesTheSameBytesTwice) {
  write("a", {{.drive = "x", .ate_m = 1, .seed = 4}, {.drive = "y", .ate_m = 2}});
  for (const char* const file : {"results.csv", "results.json", "results.md", "report.html"})
    EXPECT_TRUE(merged(file) == merged(file)) << file;
}

}  // namespace
}  // namespace motorcade
