#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>

#include "io/mask_image.hpp"
#include "io/object_points.hpp"
#include "io/run_folder.hpp"
#include "tests/support/data_folder.hpp"

/// `motorcade run` from outside, on a short rendered drive that the build's test fixture makes.
namespace motorcade {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

const fs::path kSequence = MOTORCADE_RENDERED_SEQUENCE;
constexpr std::size_t kFrames = MOTORCADE_RENDERED_FRAMES;
const std::vector<std::string> kReproducible{"camera_online.txt", "camera_final.txt",   "camera_online.tum",
                                             "camera_final.tum",  "objects_online.csv", "objects_final.csv"};

std::string contentOf(const fs::path& file) {
  std::ostringstream content;
  content << std::ifstream(file, std::ios::binary).rdbuf();
  return content.str();
}

class Run : public testing::Test {
 protected:
  Run()
      : folder_(fs::path(testing::TempDir()) /
                ("motorcade_run_" + std::string(testing::UnitTest::GetInstance()->current_test_info()->name()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~Run() override { fs::remove_all(folder_); }

  /// Runs the program and gives its exit code.
  int motorcade(const std::string& arguments, const std::string& prefix = "") {
    const std::string command =
        prefix + MOTORCADE_PROGRAM " " + arguments + " >" + (folder_ / "stdout").string() + " 2>" + errors().string();
    return WEXITSTATUS(std::system(command.c_str()));
  }
  int run(const std::string& name, const std::string& options = "", const fs::path& sequence = kSequence) {
    return motorcade("run " + sequence.string() + " --out " + out(name).string() + " " + options);
  }
  fs::path out(const std::string& name) const { return folder_ / name; }
  fs::path errors() const { return folder_ / "stderr"; }
  nlohmann::json summary(const std::string& name) const {
    return nlohmann::json::parse(contentOf(out(name) / "summary.json"));
  }

  /// The measures of a run against the truth of its sequence.
  nlohmann::json evaluate(const std::string& name, const fs::path& sequence = kSequence) {
    const fs::path file = folder_ / (name + ".json");
    EXPECT_EQ(
        motorcade("evaluate " + out(name).string() + " --sequence " + sequence.string() + " --json " + file.string()),
        0)
        << contentOf(errors());
    return nlohmann::json::parse(contentOf(file));
  }

  /// A copy of the rendered drive with one image cut short.
  fs::path damagedSequence() {
    fs::path copy = folder_ / "damaged";
    fs::copy(kSequence, copy, fs::copy_options::recursive);
    for (const auto& entry : fs::directory_iterator(copy / "image_0"))
      if (entry.path().stem() == "000003") fs::resize_file(entry.path(), 100);
    return copy;
  }

  void expectSame(const std::string& a, const std::string& b) {
    for (const std::string& file : kReproducible)
      EXPECT_TRUE(contentOf(out(a) / file) == contentOf(out(b) / file)) << file;
  }

 private:
  fs::path folder_;
};

TEST_F(Run, WritesTheSameBytesForEveryNumberOfThreadsAndEveryRate) {
  ASSERT_EQ(run("two", "--threads 2"), 0) << contentOf(errors());
  ASSERT_EQ(run("one", "--threads 1"), 0);
  ASSERT_EQ(run("paced", "--threads 2 --rate 25 --set pipeline.frames_in_flight=2"), 0);
  expectSame("two", "one");
  expectSame("two", "paced");
}

TEST_F(Run, WritesALinePerFrameAndACompleteSummary) {
  ASSERT_EQ(run("out", "--require tracked=0.9"), 0) << contentOf(errors());
  const RunFolder folder = readRunFolder(out("out"));
  EXPECT_EQ(folder.frames.size(), kFrames);
  EXPECT_EQ(folder.online.camera.size(), kFrames);
  EXPECT_EQ(folder.final.camera.size(), kFrames);
  const auto json = summary("out");
  EXPECT_EQ(json["complete"], true);
  EXPECT_EQ(json["frames"]["received"], kFrames);
  EXPECT_EQ(json["latency_ms"]["count"], kFrames);
  EXPECT_GE(json["stolen_s"], 0);
  EXPECT_GE(json["involuntary_switches"], 0);
  for (const auto& queue : json["queues"]) EXPECT_LE(queue["high_water"], json["frames_in_flight"]) << queue;
}

TEST_F(Run, FollowsTheCameraAndTheCarAheadOnARenderedDrive) {
  ASSERT_EQ(run("out"), 0) << contentOf(errors());
  const auto measured = evaluate("out")["final"];
  EXPECT_LT(measured["camera"]["rpe_t_m"]["rmse"], 0.01);  // it reaches 0.002: room for other processors' rounding
  EXPECT_LT(measured["camera"]["rpe_r_deg"]["rmse"], 0.02);
  ASSERT_EQ(measured["objects"].size(), 1U);
  EXPECT_LT(measured["motion"]["me_t_m"]["mean"], 0.05);
  EXPECT_GT(measured["detection"]["within_30m"]["recall"], 0.9);
  EXPECT_EQ(measured["detection"]["false_rows"], 0);
}

TEST_F(Run, KnowsWhatTheCarAheadIsAndWhereItsOutlineIs) {
  ASSERT_EQ(run("out", "--masks"), 0) << contentOf(errors());
  const auto boxes = evaluate("out")["final"]["boxes_within_30m"];
  ASSERT_GT(boxes["rows"], 5);
  EXPECT_EQ(boxes["rows"], boxes["rows_with_cuboid"]);
  EXPECT_GT(boxes["iou_2d"], 0.7);
  EXPECT_GT(boxes["iou_bird"], 0.5);
  for (const auto& row : readRunFolder(out("out")).final.objects) EXPECT_EQ(row.object.cuboid->kind, ObjectKind::kCar);

  double iou = 0;
  int masks = 0;
  for (const auto& row : readRunFolder(out("out")).online.objects) {
    const Gray16Image mask = readPng16(maskFile(out("out") / "masks", row.frame)),
                      truth = readPng16(maskFile(kSequence / "instance", row.frame));
    ASSERT_EQ(mask.pixels.size(), truth.pixels.size());
    std::map<std::uint16_t, int> shown;  // by what of the truth
    int found = 0;
    for (std::size_t i = 0; i < mask.pixels.size(); ++i)
      if (mask.pixels[i] == row.object.track.value + 1) ++found, ++shown[truth.pixels[i]];
    shown.erase(0);
    if (shown.empty()) continue;
    const auto most = std::ranges::max_element(shown, {}, [](const auto& entry) { return entry.second; });
    const auto size = std::ranges::count(truth.pixels, most->first);
    iou += static_cast<double>(most->second) / static_cast<double>(found + size - most->second);
    ++masks;
  }
  ASSERT_GT(masks, 5);
  EXPECT_GT(iou / masks, 0.65);
}

TEST_F(Run, WritesOutlinesAndPointsWithTheMasksAndRemovesThemNextTime) {
  ASSERT_EQ(run("out", "--masks"), 0) << contentOf(errors());
  const auto rows = readRunFolder(out("out")).online.objects;
  ASSERT_FALSE(rows.empty());
  std::map<std::pair<FrameId, TrackId>, int> points;
  for (const ObjectPoint& point : readObjectPoints(out("out") / kObjectPointsFile))
    ++points[{point.frame, point.track}];
  for (const auto& row : rows) EXPECT_EQ((points[{row.frame, row.object.track}]), row.object.points) << row.frame.value;

  std::ifstream outlines(out("out") / "outlines.jsonl");
  int count = 0;
  for (std::string line; std::getline(outlines, line); ++count) {
    const auto outline = nlohmann::json::parse(line);
    const Gray16Image mask = readPng16(maskFile(out("out") / "masks", {outline["frame"]}));
    for (const auto& corner : outline["polygons"].at(0))
      EXPECT_NE(mask.pixels[corner[1].get<int>() * mask.width + corner[0].get<int>()], 0) << line;
  }
  EXPECT_GT(count, 5);
  EXPECT_NEAR(rows.back().object.age_s, 0.1 * static_cast<double>(rows.back().frame.value - rows.front().frame.value),
              2e-3);

  ASSERT_EQ(run("out"), 0) << contentOf(errors());
  EXPECT_FALSE(fs::exists(out("out") / kObjectPointsFile));
  EXPECT_FALSE(fs::exists(out("out") / "outlines.jsonl"));
  EXPECT_FALSE(fs::exists(maskFile(out("out") / "masks", {0})));
}

TEST_F(Run, FollowsItsOwnEffectiveConfiguration) {
  ASSERT_EQ(run("first", "--set frontend.optical_flow.max_tracks=400"), 0) << contentOf(errors());
  ASSERT_EQ(run("second", "--config " + (out("first") / "effective_config.toml").string()), 0) << contentOf(errors());
  EXPECT_EQ(contentOf(out("first") / "effective_config.toml"), contentOf(out("second") / "effective_config.toml"));
  expectSame("first", "second");
}

TEST_F(Run, RunsTheOtherDetectorAndTheOtherBackends) {
  EXPECT_EQ(run("sift", "--set frontend.detector=sift --require tracked=0.8"), 0) << contentOf(errors());
  for (const std::string backend : {"filter", "filter_map", "pose_graph"})
    EXPECT_EQ(run(backend, "--set backend=" + backend + " --require tracked=0.9"), 0) << contentOf(errors());
}

TEST_F(Run, TakesAnotherCameraPathWhereTheBackendUsesOne) {
  ASSERT_EQ(run("first", "--set backend=filter"), 0) << contentOf(errors());
  const std::string camera = " --camera " + (out("first") / "camera_final.txt").string();
  ASSERT_EQ(run("second", "--set backend=filter" + camera), 0) << contentOf(errors());
  const auto first = readRunFolder(out("first")).final.camera, second = readRunFolder(out("second")).final.camera;
  constexpr double kPrinted_m = 1e-6;  // nine digits
  EXPECT_NEAR((first.back().translation() - second.back().translation()).norm(), 0, kPrinted_m);
  EXPECT_EQ(run("joint", "--set backend=joint" + camera), 2);
  EXPECT_THAT(contentOf(errors()), HasSubstr("--camera"));
  std::ofstream(out("short.txt")) << "1 0 0 0 0 1 0 0 0 0 1 0\n";
  EXPECT_EQ(run("short", "--set backend=filter --camera " + out("short.txt").string()), 3);
  EXPECT_THAT(contentOf(errors()), HasSubstr("1 poses"));
}

TEST_F(Run, ReordersAndRelinearizesEveryNUpdates) {
  ASSERT_EQ(run("every",
                "--set backend.kind=pose_graph --set backend.relinearization=every "
                "--set backend.relinearize_every_updates=3"),
            0)
      << contentOf(errors());
  EXPECT_GT(summary("every")["solver"]["relinearizations"], 0);
  EXPECT_GT(summary("every")["solver"]["reorderings"], 0);
}

TEST_F(Run, TakesOnlyTheFramesAskedFor) {
  ASSERT_EQ(run("part", "--frames 2:5"), 0) << contentOf(errors());
  const RunFolder folder = readRunFolder(out("part"));
  EXPECT_EQ(folder.first_frame, 2);
  EXPECT_EQ(folder.final.camera.size(), 3u);
  EXPECT_EQ(run("none", "--frames 1000:"), 2);
}

TEST_F(Run, RejectsADamagedImageAndGoesOn) {
  const fs::path damaged = damagedSequence();
  ASSERT_EQ(run("out", "", damaged), 0) << contentOf(errors());
  const RunFolder folder = readRunFolder(out("out"));
  ASSERT_EQ(folder.frames.size(), kFrames);
  EXPECT_EQ(folder.frames[3].status, FrameStatus::kRejected);
  EXPECT_EQ(folder.final.camera.size(), kFrames);
  EXPECT_EQ(summary("out")["frames"]["rejected"], 1);
  EXPECT_THAT(contentOf(errors()), HasSubstr("000003"));
  EXPECT_EQ(run("strict", "--require tracked=1", damaged), 5);
}

TEST_F(Run, AccountsForEveryFrameOfALiveCameraThatIsTooFast) {
  ASSERT_EQ(run("live", "--live --rate 300 --set backend.budget_ms=1"), 0) << contentOf(errors());
  const auto frames = summary("live")["frames"];
  EXPECT_EQ(frames["received"], kFrames);
  EXPECT_EQ(frames["received"],
            frames["processed"].get<int>() + frames["dropped"].get<int>() + frames["rejected"].get<int>());
  const RunFolder folder = readRunFolder(out("live"));
  EXPECT_EQ(folder.frames.size(), kFrames);
  EXPECT_EQ(folder.online.camera.size(), kFrames);
  EXPECT_EQ(folder.final.camera.size(), kFrames);
}

TEST_F(Run, FlushesItsResultsWhenASignalEndsIt) {
  const auto interrupted = [&](const std::string& signal) {
    return motorcade("run " + kSequence.string() + " --rate 1 --out " + out(signal).string(),
                     "timeout --preserve-status -s " + signal + " 2 ");
  };
  EXPECT_EQ(interrupted("INT"), 130);
  EXPECT_EQ(interrupted("TERM"), 143);
  const RunFolder folder = readRunFolder(out("INT"));
  EXPECT_GE(folder.frames.size(), 1u);
  EXPECT_EQ(folder.final.camera.size(), folder.frames.size());
  EXPECT_EQ(summary("INT")["complete"], false);
}

TEST_F(Run, RefusesInputsThatWouldBeWaitedFor) {
  const std::map<std::string, std::string> answers{{"calib.txt", "calib.txt: is a FIFO"},
                                                   {"times.txt", "times.txt: is a FIFO"},
                                                   {"image_1/000002.png", "image_0/000002.png has no partner"}};
  for (const auto& [file, answer] : answers) {
    const fs::path copy = out("copy");
    fs::remove_all(copy);
    fs::copy(kSequence, copy, fs::copy_options::recursive);
    fs::remove(copy / file);
    ASSERT_EQ(std::system(("mkfifo " + (copy / file).string()).c_str()), 0);
    EXPECT_EQ(motorcade("run " + copy.string() + " --out " + out("fifo").string(), "timeout 60 "), 3) << file;
    EXPECT_THAT(contentOf(errors()), HasSubstr(answer));
  }
}

TEST_F(Run, WarnsOfTimesAndCalibrationsThatCannotBe) {
  EXPECT_EQ(run("clean"), 0);
  EXPECT_THAT(contentOf(errors()), Not(HasSubstr("warning")));
  const fs::path copy = out("copy");
  fs::copy(kSequence, copy, fs::copy_options::recursive);
  ASSERT_EQ(
      std::system(("sed -i 's/^0\\.\\([0-9]\\)/\\100./; s/^1\\.\\([0-9]\\)/1\\100./' " + (copy / "times.txt").string())
                      .c_str()),
      0);
  EXPECT_EQ(run("milliseconds", "", copy), 0);
  EXPECT_THAT(contentOf(errors()), HasSubstr("times must be in seconds"));
  std::ofstream times(copy / "times.txt");
  for (std::size_t frame = 0; frame < kFrames; ++frame) times << 100 * frame << '\n';
  times.close();
  EXPECT_EQ(run("milliseconds", "", copy), 0);
  EXPECT_THAT(contentOf(errors()), HasSubstr("times must be in seconds"));
  ASSERT_EQ(std::system(("sed -i 's/-387\\.5/-387500/' " + (copy / "calib.txt").string()).c_str()), 0);
  EXPECT_EQ(run("millimeters", "", copy), 0);
  EXPECT_THAT(contentOf(errors()), HasSubstr("must be in meters"));
}

TEST_F(Run, ASecondRunIntoTheSameFolderIsRefused) {
  const std::string first =
      MOTORCADE_PROGRAM " run " + kSequence.string() + " --rate 1 --out " + out("shared").string();
  const std::string started = "timeout -s INT 60 " + first + " >/dev/null 2>&1 & until [ -s " +
                              (out("shared") / "frames.csv").string() + " ]; do sleep 0.1; done; ";
  EXPECT_EQ(motorcade("run " + kSequence.string() + " --out " + out("shared").string(), started), 4);
  EXPECT_THAT(contentOf(errors()), HasSubstr("is in use by another run"));
  std::system(("pkill -INT -f '" + first + "'").c_str());
}

TEST_F(Run, NoticesThatItsFolderIsGone) {
  const std::string removal = "(until [ $(cat " + (out("gone") / "frames.csv").string() +
                              " 2>/dev/null | wc -l) -gt 2 ]; do sleep 0.1; done; mv " + out("gone").string() + " " +
                              out("moved").string() + ") & ";
  EXPECT_EQ(motorcade("run " + kSequence.string() + " --rate 2 --out " + out("gone").string(), removal), 4);
  EXPECT_THAT(contentOf(errors()), HasSubstr("was removed, renamed or unmounted"));
  EXPECT_LT(readRunFolder(out("moved")).frames.size(), kFrames);
}

TEST_F(Run, EndsWithAnErrorWhereFilesMayNotGrow) {
  EXPECT_EQ(run("small", ""), 0);
  EXPECT_EQ(motorcade("run " + kSequence.string() + " --out " + out("small").string(), "ulimit -f 1; "), 4);
  EXPECT_THAT(contentOf(errors()), HasSubstr("File too large"));
}

TEST_F(Run, TellsWhatIsWrongByItsExitCode) {
  EXPECT_EQ(motorcade("run"), 2);
  EXPECT_EQ(motorcade("--version"), 0);
  EXPECT_EQ(run("x", "--rate fast"), 2);
  EXPECT_EQ(run("x", "--live --rate max"), 2);
  EXPECT_EQ(run("x", "--set backend.budget_ms=1"), 2);
  EXPECT_EQ(run("x", "--require lost=1"), 2);
  EXPECT_EQ(run("x", "--threads 0"), 2);
  EXPECT_EQ(run("x", "--set frontend.corner.max_corners=5"), 2);
  EXPECT_THAT(contentOf(errors()), HasSubstr("did you mean 'frontend.corners.max_corners'"));
  EXPECT_EQ(run("x", "", out("nowhere")), 3);
  EXPECT_EQ(motorcade("run " + kSequence.string() + " --out " + (kSequence / "calib.txt").string()), 4);
}

TEST_F(Run, AnswersSettingsThatCannotWorkWithTheKeyAndItsRange) {
  for (const std::string setting :
       {"frontend.disparity_offset.window_frames=0", "frontend.point_tracks.max_missed_frames=30",
        "frontend.point_tracks.max_missed_frames=-1", "frontend.segmentation.max_gap_m=1e-6",
        "backend.window_frames=1e300", "frontend.ground_plane.max_tilt_rad=inf"}) {
    EXPECT_EQ(run("x", "--set " + setting), 2) << setting;
    EXPECT_THAT(contentOf(errors()), HasSubstr(setting.substr(0, setting.find('=')) + "' is ")) << setting;
    EXPECT_THAT(contentOf(errors()), HasSubstr(" to ")) << setting;
  }
  // Keys that once could be set to something that ended the program; they are keys no more.
  for (const std::string setting : {"frontend.motion.calibration_frames=0", "backend.factors.object_encounter_share=0",
                                    "backend.final_iterations=0", "frontend.optical_flow.patch.window_px=10",
                                    "frontend.optical_flow.min_distance_px=0"}) {
    EXPECT_EQ(run("x", "--set " + setting), 2) << setting;
    EXPECT_THAT(contentOf(errors()), HasSubstr("unknown key")) << setting;
  }
}

/// Real frames with two lead cars; the tests that need them are skipped where the data is absent.
class RealRun : public Run {
 protected:
  void SetUp() override {
    if (!fs::exists(drive_)) GTEST_SKIP() << drive_ << " is not there";
  }
  const fs::path drive_ = test::dataFolder() / "kitti_tracking_0003";
};

TEST_F(RealRun, FollowsTheCameraAndTheTwoLeadCars) {
  ASSERT_EQ(run("out", "--require tracked=1", drive_), 0) << contentOf(errors());
  const auto measured = evaluate("out", drive_)["final"];
  EXPECT_LT(measured["camera"]["ate_m"]["rmse"], 0.42);  // VISO2-S reaches 0.42 m and 0.039 deg here
  EXPECT_LT(measured["camera"]["rpe_r_deg"]["rmse"], 0.039);
  ASSERT_EQ(measured["objects"].size(), 2U);  // parked cars are never reported as moving
  for (const auto& object : measured["objects"]) {
    const double share_followed = object["followed_frames"].get<double>() / object["labeled_frames"].get<double>();
    EXPECT_GT(share_followed, 0.8) << object;
  }
  EXPECT_LE(measured["detection"]["id_switches"], 1);
  EXPECT_LE(measured["detection"]["false_rows"], 3);  // most where a label jumps by 1.5 m, in frame 61
}

TEST_F(RealRun, WritesTheSameBytesForEveryNumberOfThreads) {
  ASSERT_EQ(run("two", "--frames 0:40 --threads 2 --require tracked=1", drive_), 0) << contentOf(errors());
  ASSERT_EQ(run("one", "--frames 0:40 --threads 1", drive_), 0);
  EXPECT_FALSE(readRunFolder(out("two")).final.objects.empty());
  expectSame("two", "one");
}

TEST_F(RealRun, ChangesTheObjectsWhenAKindOfFactorIsSwitchedOff) {
  const std::string graph = "--frames 0:40 --set backend.kind=pose_graph ";
  ASSERT_EQ(run("all", graph, drive_), 0) << contentOf(errors());
  const std::string objects = contentOf(out("all") / "objects_final.csv");
  for (const std::string kind : {"motion", "smoothness", "camera_encounter", "object_encounter"}) {
    // NOLINTNEXTLINE(performance-inefficient-string-concatenation): four times in a test
    ASSERT_EQ(run(kind, graph + "--set backend.factors.use_" + kind + "=false", drive_), 0) << contentOf(errors());
    EXPECT_FALSE(contentOf(out(kind) / "objects_final.csv") == objects) << kind;
  }
}

}  // namespace
}  // namespace motorcade
