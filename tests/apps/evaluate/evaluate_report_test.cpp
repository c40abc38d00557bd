#include <cmath>
#include <functional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "apps/evaluate/report/report.hpp"
#include "io/files/errors.hpp"
#include "io/images/image_file.hpp"
#include "tests/apps/evaluate/evaluated_drive.hpp"

/// Tests the input and output of `motorcade evaluate`.
namespace motorcade::test {
namespace {

using namespace nlohmann::literals;
using testing::HasSubstr;

TEST_F(EvaluateDrive, TableJsonAndTruthAreWritten) {
  writeRun("run", 0, kFrames, [](int, FrameEstimate&) {});
  options_.json = folder_ / "measures.json";
  options_.export_truth = folder_ / "truth";
  testing::internal::CaptureStdout();
  EXPECT_EQ(runEvaluate(options_), 0);
  EXPECT_THAT(testing::internal::GetCapturedStdout(), HasSubstr("RPE_r deg"));
  const auto json = nlohmann::json::parse(folder_.read("measures.json"));
  EXPECT_NEAR(json["final"]["camera"]["rpe_t_m"]["rmse"], 0, 1e-6);
  EXPECT_EQ(json["final"]["objects"][0]["label"], 7);
  EXPECT_EQ(json["final"]["detection"]["within_30m"]["recall"], 1.0);
  EXPECT_THAT(folder_.read("truth/object_7.tum"), HasSubstr("0.100000000 2.000000000 1.600000000 16.200000000 "));
  EXPECT_THAT(folder_.read("truth/objects_truth.csv"), HasSubstr("\n0,7,Car,1,"));
  EXPECT_EQ(readKittiPoses(folder_ / "truth/camera_truth.txt").size(), static_cast<std::size_t>(kFrames));
}

TEST_F(EvaluateDrive, FramesOfFalseRowsAndMissedLabelsAreNamed) {
  writeRun("run", 0, kFrames, [](int i, FrameEstimate& estimate) {
    if (i < 5 || i == 7) estimate.objects[0].T_world_body = SE3(Eigen::Matrix3d::Identity(), {-30, 1, 60});
  });
  const Evaluation evaluation = evaluateRun(options_);
  const std::string table = tableOf(evaluation);
  EXPECT_THAT(table, HasSubstr("\n  false rows, final: track 3 in frames 0-4, 7\n"));
  EXPECT_THAT(table, HasSubstr("\n  missed to 30 m, final: label 7 in frames 0-4, 7\n"));
  const auto json = nlohmann::json::parse(jsonOf(evaluation))["final"]["detection"];
  EXPECT_EQ(json["false_in"], R"({"3": [0, 1, 2, 3, 4, 7]})"_json);
  EXPECT_EQ(json["missed_within_30m_in"], R"({"7": [0, 1, 2, 3, 4, 7]})"_json);
}

TEST_F(EvaluateDrive, ManyFramesFitIntoALine) {
  writeRun("run", 0, kFrames, [](int i, FrameEstimate& estimate) {
    if (i % 2 == 0) estimate.objects[0].T_world_body = SE3(Eigen::Matrix3d::Identity(), {-30, 1, 60});
  });
  const std::string table = tableOf(evaluateRun(options_));
  const std::size_t begin = table.find("  missed to 30 m"), end = table.find('\n', begin);
  EXPECT_LE(end - begin, 100U);
  EXPECT_THAT(table.substr(begin, end - begin), testing::EndsWith(", ..."));
}

TEST_F(EvaluateDrive, TheTableFitsAHundredColumnsAndExplainsItsMeasures) {
  writeRun("run", 0, kFrames, [](int i, FrameEstimate& estimate) {
    estimate.T_world_cam = SE3(Eigen::Matrix3d::Identity(), {100.0 * (i % 2), 0, 0}) * estimate.T_world_cam;
    for (ObjectEstimate& object : estimate.objects)
      object.cuboid = ObjectBox{.size_m = {4.2, 1.7, 1.5}, .kind = ObjectKind::kCar, .kind_probability = 0.9};
  });
  Gray16Image image{64, 32, std::vector<std::uint16_t>(64 * 32)};
  for (const auto& [name, value] : {std::pair("drive/instance", 8), std::pair("run/masks", 4)}) {
    std::filesystem::create_directories(folder_ / name);
    image.pixels[700] = static_cast<std::uint16_t>(value);
    writePng16(folder_ / name / "000002.png", image);
  }
  options_.baseline_run = options_.half_run = options_.run;
  const std::string table = tableOf(evaluateRun(options_));
  std::istringstream lines(table);
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("run ") || line.starts_with("sequence ")) continue;  // paths are as long as they are
    EXPECT_LE(line.size(), 100U) << line;
    EXPECT_FALSE(line.ends_with(' ')) << line;
  }
  for (const char* const section :
       {"camera ", "moving objects", "motion of", "detection", "boxes", "tracks of", "sizes within", "kinds",
        "existence", "masks", "covariances", "against the baseline"})
    EXPECT_THAT(table, HasSubstr(std::string("\n") + section));
  const auto legend = table.substr(table.find("\nATE "));
  for (const char* const measure : {"RPE", "ARE", "segments", "ME", "MOTA", "IoU", "log loss", "HOTA", "NEES"})
    EXPECT_THAT(legend, HasSubstr(std::string("\n") + measure)) << "has no explanation";
}

TEST_F(EvaluateDrive, TheJsonHasEveryMeasureOfTheAccuracyTables) {
  writeRun("run", 0, kFrames, [](int, FrameEstimate&) {});
  options_.baseline_run = options_.half_run = options_.run;
  const auto json = nlohmann::json::parse(jsonOf(evaluateRun(options_)));
  constexpr double kDigitsOfTheFiles = 1e-5;
  EXPECT_NEAR(json.at("/final/camera_mounted/ate_m/rmse"_json_pointer), 0, kDigitsOfTheFiles);
  EXPECT_NEAR(json.at("/online/objects/0/position/ate_m/as_seen_offset_removed/rmse"_json_pointer), 0,
              kDigitsOfTheFiles);
  EXPECT_NEAR(json.at("/final/objects_mean/ate_rmse_m/world_offset_removed"_json_pointer), 0, kDigitsOfTheFiles);
  EXPECT_NEAR(json.at("/final/objects_mean/largest_origin_drift_m/0"_json_pointer), 0, kDigitsOfTheFiles);
  EXPECT_EQ(json.at("/baseline/objects/objects_of_mean"_json_pointer), 1);
  EXPECT_NEAR(json.at("/baseline/objects/mean_relative_error/aligned"_json_pointer), 0, kDigitsOfTheFiles);
  for (const char* of : {"camera", "camera_mounted", "camera_mounted_with_truth_noise", "objects"})
    EXPECT_EQ(json.at("covariance").at(of).at("rotation").at("coverage_95"), 1) << of;
  EXPECT_NEAR(json.at("/final/hota/image/within_50m/det_a"_json_pointer), 1, kDigitsOfTheFiles);
  EXPECT_EQ(json.at("/final/hota/footprint/within_30m/rows"_json_pointer), kFrames);
  EXPECT_EQ(json.at("/online/kinds_within_30m/from_tenth_row/confusion/car/unknown"_json_pointer), kFrames - 9);
  EXPECT_NEAR(json.at("/final/kinds_within_30m/from_tenth_row/log_loss"_json_pointer), std::log(2.0), 1e-12)
      << "as none is named";
  EXPECT_EQ(json.at("/final/kinds_within_30m/from_tenth_row/sure_wrong"_json_pointer), 0);
  EXPECT_EQ(json.at("/final/kinds_within_30m/from_tenth_row/named/rows"_json_pointer), 0);
  EXPECT_TRUE(json.contains("/final/boxes_within_30m/height_within_2_sigma"_json_pointer));
  EXPECT_EQ(json.at("/final/existence/rows"_json_pointer), kFrames);
  EXPECT_EQ(json.at("/final/existence/brier"_json_pointer), 0) << "sure rows, all on the label";
  EXPECT_EQ(json.at("/online/existence/tenths/9/real"_json_pointer), kFrames);
  EXPECT_EQ(json.at("/online/first_report/within_50m/never"_json_pointer), 0);
  EXPECT_TRUE(json.at("masks").is_null());
  EXPECT_GT(json.at("/covariance/halves/objects/samples"_json_pointer), 0);
}

TEST_F(EvaluateDrive, SegmentsAndPublishedFormsAreInTableAndJson) {
  writeRun("run", 0, kFrames, [](int i, FrameEstimate& estimate) {
    estimate.T_world_cam = SE3(Eigen::Matrix3d::Identity(), {0, 0, 0.02 * i}) * estimate.T_world_cam;  // 2 % too long
    const double slip_m = i >= 12 ? 0.3 : 0.0;
    estimate.objects[0].T_world_body =
        SE3(Eigen::Matrix3d::Identity(), {slip_m, 0, 0.02 * i}) * estimate.objects[0].T_world_body;
  });
  const Evaluation evaluation = evaluateRun(options_);
  const auto json = nlohmann::json::parse(jsonOf(evaluation));
  constexpr double kDigitsOfTheFiles = 1e-5;
  for (const std::string kind : {"final", "online"}) {
    const auto& kitti = json.at(kind).at("camera").at("kitti");
    EXPECT_TRUE(kitti.at("short_segments"));
    EXPECT_EQ(kitti.at("segments"), 3);  // 10 m from frames 0 and 10, 20 m from frame 0
    EXPECT_NEAR(kitti.at("translation_percent"), (2 * 2.2 + 2.1) / 3, kDigitsOfTheFiles);
    EXPECT_NEAR(kitti.at("by_length").at(1).at("translation_percent"), 2.1, kDigitsOfTheFiles) << "21 m of 20";
    EXPECT_EQ(kitti.at("by_length").size(), 2U);
    const auto& motion = json.at(kind).at("followed_motion");
    EXPECT_EQ(motion.at("objects"), 1);
    EXPECT_NEAR(motion.at("me_t_object_rms_m"), std::sqrt(0.09 / 29 + 0.02 * 0.02), 1e-4);
    EXPECT_EQ(motion.at("each").at(0).at("label"), 7);
    EXPECT_EQ(motion.at("largest_step").at("frame"), 12);
    EXPECT_EQ(motion.at("largest_step").at("track_id"), 3);
    EXPECT_LT(motion.at("me_t_m").at("p95"), 0.1);
  }
  const std::string table = tableOf(evaluation);
  EXPECT_THAT(table, HasSubstr("segments of 10 to 80 m"));
  EXPECT_THAT(table, HasSubstr("objects' mean, online"));
  EXPECT_THAT(table, HasSubstr("frame 12, label 7, track 3"));
}

TEST_F(EvaluateDrive, TheJsonNamesTheFramesWithTheLargestErrors) {
  writeRun("run", 0, kFrames, [](int i, FrameEstimate& estimate) {
    const double jump_m = i == 20 ? 0.5 : 0.0, slip_m = i >= 12 ? 0.3 : 0.0;
    estimate.T_world_cam = SE3(Eigen::Matrix3d::Identity(), {jump_m, 0, 0}) * estimate.T_world_cam;
    for (auto& object : estimate.objects)
      object.T_world_body = SE3(Eigen::Matrix3d::Identity(), {jump_m + slip_m, 0, 0}) * object.T_world_body;
  });
  const auto worst = nlohmann::json::parse(jsonOf(evaluateRun(options_))).at("worst_frames");
  constexpr double kDigitsOfTheFiles = 1e-5;
  ASSERT_EQ(worst.at("camera").size(), 10U);
  EXPECT_NEAR(worst.at("/camera/0/rpe_t_m"_json_pointer), 0.5, kDigitsOfTheFiles);
  EXPECT_NEAR(worst.at("/camera/2/rpe_t_m"_json_pointer), 0, kDigitsOfTheFiles);
  EXPECT_EQ(worst.at("/camera/0/frame"_json_pointer).get<int>() + worst.at("/camera/1/frame"_json_pointer).get<int>(),
            20 + 21);
  const auto& objects = worst.at("objects");
  ASSERT_EQ(objects.size(), 10U);
  std::vector<double> errors_m;
  for (const auto& object : objects) errors_m.push_back(object.at("me_t_m"));
  EXPECT_THAT(errors_m, testing::WhenSortedBy(std::greater(), testing::ElementsAreArray(errors_m)));
  bool has_slip = false;
  for (const auto& object : objects) {
    EXPECT_EQ(object.at("label"), 7);
    EXPECT_EQ(object.at("track_id"), 3);
    has_slip |= object.at("frame") == 12 && std::abs(object.at("me_t_m").get<double>() - 0.3) < kDigitsOfTheFiles;
  }
  EXPECT_TRUE(has_slip);
}

TEST_F(EvaluateDrive, TheRunTellsOfWhichSequenceItIs) {
  writeRun("run", 0, kFrames, [](int, FrameEstimate&) {});
  folder_.write("run/summary.json", R"({"sequence": ")" + options_.sequence.string() + "\"}");
  options_.sequence.clear();
  const Evaluation evaluation = evaluateRun(options_);
  EXPECT_EQ(evaluation.sequence, folder_ / "drive");
  EXPECT_NEAR(evaluation.final.camera->ate_m.rmse, 0, 1e-6);
  std::filesystem::remove(folder_ / "run/summary.json");
  EXPECT_THAT(messageOf<InputError>([&] { evaluateRun(options_); }), HasSubstr("summary.json"));
}

TEST_F(EvaluateDrive, RunsOfOtherSequencesAreRefused) {
  const auto nothing = [](int, FrameEstimate&) {};
  writeRun("run", 0, kFrames, nothing);
  writeRun("longer", 0, kFrames + 1, nothing);
  options_.run = folder_ / "longer";
  EXPECT_THAT(messageOf<InputError>([&] { evaluateRun(options_); }), HasSubstr("longer: is no run of"));
  options_.run = folder_ / "run";
  options_.baseline_run = folder_ / "longer";
  EXPECT_THAT(messageOf<InputError>([&] { evaluateRun(options_); }), HasSubstr("longer: is no run of"));
  options_.baseline_run.clear();
  options_.half_run = folder_ / "longer";
  EXPECT_THAT(messageOf<InputError>([&] { evaluateRun(options_); }), HasSubstr("longer: is no run of"));
}

}  // namespace
}  // namespace motorcade::test
