#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include <gmock/gmock.h>

#include "io/results/run_folder.hpp"
#include "tests/apps/program_run.hpp"

/// Tests the answers of `motorcade run` to inputs, outputs and settings that cannot work.
namespace motorcade::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST_F(Run, RejectsADamagedImageAndGoesOn) {
  const fs::path damaged = damagedSequence();
  ASSERT_EQ(run("out", "", damaged), 0) << contentOf(errors());
  const RunFolder folder = readRunFolder(out("out"));
  ASSERT_EQ(folder.frames.size(), kFrames);
  EXPECT_EQ(folder.frames[3].head.status, FrameStatus::kRejected);
  EXPECT_EQ(folder.final.camera.size(), kFrames);
  EXPECT_EQ(summary("out")["frames"]["rejected"], 1);
  EXPECT_THAT(contentOf(errors()), HasSubstr("000003"));
  EXPECT_EQ(run("strict", "--require tracked=1", damaged), 5);
}

TEST_F(Run, EndsWithAnErrorWhereNothingIsFollowed) {
  const std::map<std::string, std::string> answers{{"truncated", "most of them, 14, cannot be used: "},
                                                   {"drop", "most of them, 14, did not come"},
                                                   {"one_eyed", "most of them, 14, could not be worked on: "},
                                                   {"black", "show nothing of the frame before"}};
  for (const auto& [faults, answer] : answers) {
    EXPECT_EQ(run("nothing", "--force --inject " + faults), 3) << faults;
    EXPECT_THAT(contentOf(errors()), AllOf(HasSubstr("no motion was measured in 14 frames; "), HasSubstr(answer)));
  }
  EXPECT_EQ(run("one", "--force --frames 3:4"), 0) << "a single frame has no motion, and is good";
}

TEST_F(Run, RefusesImagesThatAreLargerThanTheConfigurationAllows) {
  EXPECT_EQ(run("large", "--set input.max_pixels=1000"), 3);
  EXPECT_THAT(contentOf(errors()), HasSubstr("input.max_pixels is 1000"));
}

TEST_F(Run, RefusesInputsThatWouldBeWaitedFor) {
  const std::map<std::string, std::string> answers{{"calib.txt", "calib.txt: is a FIFO"},
                                                   {"times.txt", "times.txt: is a FIFO"}};
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

TEST_F(Run, WarnsOfTimesAndRefusesCalibrationsThatCannotBe) {
  EXPECT_EQ(run("clean"), 0);
  EXPECT_THAT(contentOf(errors()), Not(HasSubstr("warning")));
  const fs::path copy = out("copy");
  fs::copy(kSequence, copy, fs::copy_options::recursive);
  ASSERT_EQ(
      std::system(("sed -i 's/^0\\.\\([0-9]\\)/\\100./; s/^1\\.\\([0-9]\\)/1\\100./' " + (copy / "times.txt").string())
                      .c_str()),
      0);
  EXPECT_EQ(run("milliseconds", "", copy), 0);
  EXPECT_THAT(contentOf(errors()), HasSubstr("are taken as milliseconds"));
  std::ofstream times(copy / "times.txt");
  for (std::size_t frame = 0; frame < kFrames; ++frame) times << 1e-4 * static_cast<double>(frame) << '\n';
  times.close();
  EXPECT_EQ(run("too_close", "", copy), 3);
  EXPECT_THAT(contentOf(errors()), AllOf(HasSubstr("0.0001 s apart"), HasSubstr("must be in seconds")));
  ASSERT_EQ(std::system(("sed -i 's/-387\\.5/-387500/' " + (copy / "calib.txt").string()).c_str()), 0);
  EXPECT_EQ(run("millimeters", "", copy), 3);
  EXPECT_THAT(contentOf(errors()), HasSubstr("must be in meters"));
}

TEST_F(Run, ASecondRunIntoTheSameFolderIsRefused) {
  const std::string run_there = "run " + kSequence.string() + " --out " + out("shared").string();
  const std::string first = MOTORCADE_PROGRAM " " + run_there + " --rate 1 >/dev/null 2>&1 & ";
  EXPECT_EQ(motorcade(run_there, first + waitForLines(out("shared") / "frames.csv", 0)), 4);
  EXPECT_THAT(contentOf(errors()), HasSubstr("is in use by another run"));
}  // the first run ends when its folder is removed

TEST_F(Run, AFinishedRunIsReplacedOnlyWhereTheUserSaysSo) {
  ASSERT_EQ(run("out", "--frames 0:4"), 0) << contentOf(errors());
  const std::string before = contentOf(out("out") / "summary.json");
  EXPECT_EQ(run("out", "--frames 0:3"), 4);
  EXPECT_THAT(contentOf(errors()), AllOf(HasSubstr(out("out").string()), HasSubstr("--force")));
  EXPECT_EQ(contentOf(out("out") / "summary.json"), before);
  EXPECT_EQ(readRunFolder(out("out")).frames.size(), 4U);
  EXPECT_EQ(run("out", "--frames 0:3 --force"), 0) << contentOf(errors());
  EXPECT_EQ(readRunFolder(out("out")).frames.size(), 3U);
}

TEST_F(Run, NoticesThatItsFolderIsGone) {
  std::ostringstream removal;
  removal << "(" << waitForLines(out("gone") / "frames.csv", 2) << "mv " << out("gone").string() << " "
          << out("moved").string() << ") & ";
  EXPECT_EQ(motorcade("run " + kSequence.string() + " --rate 2 --out " + out("gone").string(), removal.str()), 4);
  EXPECT_THAT(contentOf(errors()), HasSubstr("was removed, renamed or unmounted"));
  EXPECT_LT(readRunFolder(out("moved")).frames.size(), kFrames);
}

TEST_F(Run, EndsWithAnErrorWhereFilesMayNotGrow) {
  EXPECT_EQ(run("small", ""), 0);
  EXPECT_EQ(motorcade("run " + kSequence.string() + " --force --out " + out("small").string(), "ulimit -f 1; "), 4);
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
       {"frontend.optical_flow.max_tracks=0", "frontend.point_tracks.max_missed_frames=30",
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

}  // namespace
}  // namespace motorcade::test
