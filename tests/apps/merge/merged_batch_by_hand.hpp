#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "apps/evaluate/measures/covariance_measures.hpp"
#include "apps/merge/merged_files.hpp"
#include "apps/tasks/batch_folder.hpp"
#include "apps/tasks/plan.hpp"
#include "apps/tasks/task_record.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade::test {

/// A batch whose results are written by hand.
class MergeBatch : public testing::Test {
 protected:
  struct Result {
    std::string drive, set = "default";
    double ate_m = 0;
    std::optional<std::uint32_t> seed{};
    int repetition = 1;
    bool labels = true;
  };

  static Task taskOf(const Result& result) {
    std::string name = result.drive;
    if (result.seed) name.append("-").append(std::to_string(*result.seed));
    name.append(".").append(result.set);
    if (result.repetition > 1) name.append(".").append(std::to_string(result.repetition));
    return {.name = name,
            .drive = result.drive,
            .set = result.set,
            .seed = result.seed,
            .repetition = result.repetition,
            .sequence = "/nowhere",
            .fingerprint = "f"};
  }

  /// Rows that all claim the same, of the ninth tenth; `hits` is the key of the number that are as they say.
  static nlohmann::json reliabilityOf(const char* hits, int rows, int hit, double claimed) {
    nlohmann::json tenths(10, {{"rows", 0}, {hits, 0}, {"probability_sum", 0}});
    tenths[8] = {{"rows", rows}, {hits, hit}, {"probability_sum", claimed * rows}};
    const double squares = hit * (1 - claimed) * (1 - claimed) + (rows - hit) * claimed * claimed;
    return {{"rows", rows}, {"brier", squares / rows}, {"tenths", tenths}};
  }

  /// Ten errors along each axis, eight in the least tenth and two in the largest.
  static AxisReliability eightOfTenErrors() {
    AxisReliability reliability;
    for (auto& axis : reliability.errors) axis.front() = 8, axis.back() = 2;
    return reliability;
  }

  static nlohmann::json evaluationOf(const Result& result) {
    nlohmann::json json;
    json["frames"] = 50;
    json["final"]["camera"] = {{"ate_m", {{"rmse", result.ate_m}}}, {"end_error_percent", 0.5}};
    json["final"]["camera"]["kitti"] = {{"segments", 12},
                                        {"translation_percent", 1.234},
                                        {"rotation_deg_per_m", 0.00321},
                                        {"by_length", {{{"length_m", result.labels ? 100 : 10}}}}};
    json["online"]["camera"]["kitti"] = {{"translation_percent", 2.5}, {"rotation_deg_per_m", 0.004}};
    const nlohmann::json by_axis = jsonOf(eightOfTenErrors());
    json["covariance"] = {
        {"camera", {{"by_axis", by_axis}}},
        {"camera_mounted_with_truth_noise", nullptr},
        {"final", {{"camera", {{"by_axis", by_axis}}}, {"camera_since_start", {{"by_axis", by_axis}}}}}};
    json["worst_frames"] = {{"camera", {{{"frame", 7}, {"rpe_t_m", result.ate_m}, {"rpe_r_deg", 0.1}}}},
                            {"objects", nlohmann::json::array()}};
    if (!result.labels) return json;
    json["final"]["detection"] = {{"within_30m", {{"labels", 10}, {"found", 9}}}, {"rows", 12}, {"false_rows", 1}};
    json["final"]["existence"] = reliabilityOf("real", 120, 90, 0.8);
    json["online"]["existence"] = reliabilityOf("real", 80, 80, 0.8);
    json["final"]["kinds_within_30m"]["from_tenth_row"] = {{"rows", 60},
                                                           {"right", 0.75},
                                                           {"log_loss", 0.625},
                                                           {"sure_wrong", 0.125},
                                                           {"named", reliabilityOf("right", 50, 45, 0.8)}};
    json["final"]["boxes_within_30m"] = {{"rows", 10},
                                         {"rows_with_cuboid", 10},
                                         {"length_within_2_sigma", 0.75},
                                         {"width_within_2_sigma", 0.5},
                                         {"height_within_2_sigma", 1}};
    json["final"]["motion"]["me_t_m"] = {{"mean", 2 * result.ate_m}, {"count", 4}};
    json["final"]["followed_motion"] = {{"objects", 2},
                                        {"me_t_object_rms_m", 0.625},
                                        {"me_r_object_rms_deg", 0.25},
                                        {"me_t_m", {{"p95", 0.75}, {"max", 1.5}, {"count", 4}}}};
    json["online"]["followed_motion"] = {{"objects", 2}, {"me_t_object_rms_m", 0.875}, {"me_r_object_rms_deg", 0.5}};
    return json;
  }

  void write(const std::string& batch, const std::vector<Result>& results, std::vector<Task> others = {}) {
    const BatchFolder folder(root_ / batch);
    Plan plan{.manifest = root_ / "m.toml"};
    for (const Result& result : results) {
      const Task task = taskOf(result);
      plan.tasks.push_back(task);
      const std::filesystem::path place = folder.result(task.name);
      std::filesystem::create_directories(runIn(place));
      writeTaskRecord(recordIn(place), {.task = task.name, .fingerprint = "f"});
      std::ofstream(evaluationIn(place)) << evaluationOf(result);
      std::ofstream(runIn(place) / "summary.json") << R"({"frames": {"received": 50, "tracked_fraction": 1}, "cpu_s": 2,
        "latency_ms": {"count": 50, "p50": 20, "p99": 30, "buckets": [[20, 30], [30, 20]]}, "peak_memory_bytes": 5e7})";
    }
    for (Task& task : others) plan.tasks.push_back(std::move(task));
    std::filesystem::create_directories(root_ / batch);
    writePlan(folder.plan(), plan);
  }

  std::string merged(const std::string& file, const MergeOptions& options) {
    EXPECT_EQ(runMerge(options), 0);
    return contentOf(options.batch / "merged" / file);
  }
  std::string merged(const std::string& file) { return merged(file, {.batch = root_ / "a"}); }

  const test::TemporaryFolder root_;
};

}  // namespace motorcade::test
