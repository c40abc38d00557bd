#include <cmath>
#include <fstream>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "apps/merge/batch_comparison.hpp"
#include "apps/merge/merge_command.hpp"
#include "apps/merge/merged_files.hpp"
#include "apps/merge/paired_test.hpp"
#include "apps/tasks/batch_folder.hpp"
#include "apps/tasks/task_record.hpp"
#include "io/errors.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// P by trying all signs of the ranks of 1, 2, ..., or of magnitudes with ties.
double bruteForce(const std::vector<double>& differences) {
  std::vector<double> ranks;
  for (const double a : differences) {
    double below = 0, equal = 0;
    for (const double b : differences) {
      below += std::abs(b) < std::abs(a);
      equal += std::abs(b) == std::abs(a);
    }
    ranks.push_back(below + (equal + 1) / 2);
  }
  double all = 0, positive = 0;
  for (std::size_t i = 0; i < ranks.size(); ++i) {
    all += ranks[i];
    positive += differences[i] > 0 ? ranks[i] : 0;
  }
  const double smaller = std::min(positive, all - positive);
  int count = 0;
  const int signs = 1 << ranks.size();
  for (int sign = 0; sign < signs; ++sign) {
    double sum = 0;
    for (std::size_t i = 0; i < ranks.size(); ++i) sum += (sign >> i & 1) != 0 ? ranks[i] : 0;
    count += sum <= smaller + 1e-9;
  }
  return std::min(1.0, 2.0 * count / signs);
}

TEST(SignedRankTest, IsThatOfAllSigns) {
  for (const std::vector<double>& differences : std::vector<std::vector<double>>{{1},
                                                                                 {1, 2, 3, 4, 5, 6},
                                                                                 {1, -2, 3, -4, 5},
                                                                                 {2, 2, -2, 1, 1, 3, -7},
                                                                                 {-1, -1, -1, -1},
                                                                                 {5, -4, 3, 2, 2, -1, 6, 9}})
    EXPECT_NEAR(signedRankTest(differences), bruteForce(differences), 1e-12);
}

TEST(SignedRankTest, GivesThePublishedCriticalValues) {
  // Wilcoxon's table, two-sided .05: n = 6: a sum of 0; n = 10: 8; n = 20: 52.
  const auto withSum = [](int n, int sum) {
    std::vector<double> differences;
    for (int rank = n; rank >= 1; --rank) {
      const bool negative = rank <= sum;
      sum -= negative ? rank : 0;
      differences.push_back(negative ? -rank : rank);
    }
    return signedRankTest(differences);
  };
  for (const auto& [n, sum] : {std::pair(6, 0), std::pair(10, 8), std::pair(20, 52)}) {
    EXPECT_LT(withSum(n, sum), 0.05) << n;
    EXPECT_GT(withSum(n, sum + 1), 0.05) << n;
  }
}

TEST(SignedRankTest, ManyDifferencesAreTestedByTheNormalDistribution) {
  std::vector<double> many;
  for (int i = 1; i <= 200; ++i) many.push_back(i % 5 == 0 ? -i : i);
  std::vector<double> few(many.begin(), many.begin() + kMostExact);
  EXPECT_LT(signedRankTest(many), 1e-6);
  std::vector<double> balanced;
  for (int i = 1; i <= 100; ++i) balanced.insert(balanced.end(), {1.0 * i, -1.0 * i});
  EXPECT_NEAR(signedRankTest(balanced), 1, 0.01);
  // Where the exact one ends, both agree.
  const double exact = signedRankTest(few);
  few.push_back(1e-9);
  EXPECT_NEAR(std::log(signedRankTest(few)), std::log(exact), 0.5);
}

TEST(SignedRankTest, ZerosSayNothing) {
  EXPECT_EQ(signedRankTest({}), 1);
  EXPECT_EQ(signedRankTest({0, 0}), 1);
  EXPECT_EQ(signedRankTest({0, 3, 1, 0, 2}), signedRankTest({3, 1, 2}));
}

TEST(HolmCorrected, MultipliesByTheTestsThatAreLeftAndNeverFalls) {
  EXPECT_THAT(holmCorrected({0.01, 0.04, 0.03, 0.005}),
              testing::Pointwise(testing::DoubleNear(1e-12), {0.03, 0.06, 0.06, 0.02}));
}

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

/// A batch whose results are written by hand.
class MergeBatch : public testing::Test {
 protected:
  MergeBatch()
      : root_(fs::path(testing::TempDir()) /
              ("merge_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()))) {
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  ~MergeBatch() override { fs::remove_all(root_); }

  struct Result {
    std::string drive, set = "default";
    double ate_m = 0;
    std::optional<std::uint32_t> seed{};
    int repetition = 1;
    bool labels = true;
  };

  static Task taskOf(const Result& result) {
    std::string name = result.drive + (result.seed ? "-" + std::to_string(*result.seed) : "") + "." + result.set;
    if (result.repetition > 1) name += "." + std::to_string(result.repetition);
    return {.name = name,
            .drive = result.drive,
            .set = result.set,
            .seed = result.seed,
            .repetition = result.repetition,
            .sequence = "/nowhere",
            .fingerprint = "f"};
  }

  static nlohmann::json evaluationOf(const Result& result) {
    nlohmann::json json;
    json["frames"] = 50;
    json["final"]["camera"] = {{"ate_m", {{"rmse", result.ate_m}}}, {"end_error_percent", 0.5}};
    json["worst_frames"] = {{"camera", {{{"frame", 7}, {"rpe_t_m", result.ate_m}, {"rpe_r_deg", 0.1}}}},
                            {"objects", nlohmann::json::array()}};
    if (!result.labels) return json;
    json["final"]["detection"] = {{"within_30m", {{"labels", 10}, {"found", 9}}}, {"rows", 12}, {"false_rows", 1}};
    json["final"]["motion"]["me_t_m"] = {{"mean", 2 * result.ate_m}, {"count", 4}};
    return json;
  }

  void write(const std::string& batch, const std::vector<Result>& results, std::vector<Task> others = {}) {
    const BatchFolder folder(root_ / batch);
    Plan plan{.manifest = root_ / "m.toml"};
    for (const Result& result : results) {
      const Task task = taskOf(result);
      plan.tasks.push_back(task);
      const fs::path place = folder.result(task.name);
      fs::create_directories(runIn(place));
      writeTaskRecord(recordIn(place), {.task = task.name, .fingerprint = "f"});
      std::ofstream(evaluationIn(place)) << evaluationOf(result);
      std::ofstream(runIn(place) / "summary.json") << R"({"frames": {"received": 50, "tracked_fraction": 1}, "cpu_s": 2,
        "latency_ms": {"count": 50, "p50": 20, "p99": 30, "buckets": [[20, 30], [30, 20]]}, "peak_memory_bytes": 5e7})";
    }
    for (Task& task : others) plan.tasks.push_back(std::move(task));
    fs::create_directories(root_ / batch);
    writePlan(folder.plan(), plan);
  }

  std::string merged(const std::string& file, const MergeOptions& options) {
    EXPECT_EQ(runMerge(options), 0);
    std::ostringstream content;
    content << std::ifstream(options.batch / "merged" / file).rdbuf();
    return content.str();
  }
  std::string merged(const std::string& file) { return merged(file, {.batch = root_ / "a"}); }

  fs::path root_;
};

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
  EXPECT_THAT(merged("results.md"), AllOf(HasSubstr("| x | 0.252 | - | - | 0.503 | 90 % (9/10) | 1 of 12 |\n"),
                                          HasSubstr("| y | 0.5 | - | - | - | - | - |\n")));
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

TEST_F(MergeBatch, DamagedResultsAreNamed) {
  write("a", {{.drive = "x", .ate_m = 1}});
  std::ofstream(evaluationIn(BatchFolder(root_ / "a").result("x.default"))) << "{";
  try {
    runMerge({.batch = root_ / "a"});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(),
                AllOf(HasSubstr("x.default/evaluation.json: is damaged"), HasSubstr("run the batch again")));
  }
  EXPECT_THROW(runMerge({.batch = root_ / "nothing"}), InputError);
}

TEST_F(MergeBatch, TheWorstFramesComeFirst) {
  write("a", {{.drive = "x", .ate_m = 0.1}, {.drive = "y", .ate_m = 0.7}, {.drive = "z", .ate_m = 0.3}});
  const auto json = nlohmann::json::parse(merged("results.json"));
  std::vector<std::string> tasks;
  for (const auto& frame : json["worst_frames"]["camera_rpe_t_m"]) tasks.push_back(frame["task"]);
  EXPECT_THAT(tasks, testing::ElementsAre("y.default", "z.default", "x.default"));
}

TEST_F(MergeBatch, AgainstAnotherBatchWhatBecameWorseIsFound) {
  std::vector<Result> before, now;
  for (int i = 0; i < 12; ++i) {
    before.push_back({.drive = "d" + std::to_string(i), .ate_m = 1.0 + 0.01 * i});
    now.push_back({.drive = "d" + std::to_string(i), .set = "tried", .ate_m = 1.1 + 0.01 * i});
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
  EXPECT_EQ(comparison["regressions"][0]["result"], "d3");
  EXPECT_EQ(comparison["unpaired"][0], "new (not in the other batch)");
}

TEST_F(MergeBatch, FewPairsProveNothing) {
  write("a", {{.drive = "x", .ate_m = 2}});
  write("b", {{.drive = "x", .ate_m = 1}});
  const auto json = nlohmann::json::parse(merged("results.json", {.batch = root_ / "a", .against = root_ / "b"}));
  EXPECT_EQ(json["comparison"]["measures"][0]["verdict"], "too few pairs differ to tell");
}

TEST_F(MergeBatch, GivesTheSameBytesTwice) {
  write("a", {{.drive = "x", .ate_m = 1, .seed = 4}, {.drive = "y", .ate_m = 2}});
  for (const char* const file : {"results.csv", "results.json", "results.md", "report.html"})
    EXPECT_TRUE(merged(file) == merged(file)) << file;
}

}  // namespace
}  // namespace motorcade
