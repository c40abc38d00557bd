#include <string>

#include <gmock/gmock.h>

#include "io/results/run_folder.hpp"
#include "tests/apps/program_run.hpp"

/// Tests `motorcade run --inject`: the outcome of a drive with faults.
namespace motorcade::test {
namespace {

using testing::HasSubstr;

class Inject : public Run {
 protected:
  RunFolder inject(const std::string& name, const std::string& faults) {
    EXPECT_EQ(run(name, "--force --inject '" + faults + "'"), 0) << contentOf(errors());
    RunFolder folder = readRunFolder(out(name));
    EXPECT_EQ(folder.frames.size(), kFrames) << faults;
    EXPECT_EQ(folder.final.camera.size(), kFrames) << faults;
    return folder;
  }
  double drift_m(const std::string& name) { return evaluate(name)["final"]["camera"]["ate_m"]["rmse"].get<double>(); }
  static void expectFrame(const RunFolder& run, std::size_t frame, FrameStatus status, FrameCause cause) {
    EXPECT_EQ(statusName(run.frames[frame].head.status), statusName(status)) << frame;
    EXPECT_EQ(causeName(run.frames[frame].head.cause), causeName(cause)) << frame;
  }
};

TEST_F(Inject, BridgesMissingDarkFrozenAndDamagedFrames) {
  ASSERT_EQ(run("clean"), 0);
  const double clean_m = drift_m("clean");
  const struct {
    std::string faults;
    FrameStatus status;
    FrameCause cause;
  } cases[] = {{"drop@6:9", FrameStatus::kDropped, FrameCause::kTooLate},
               {"black@6:9", FrameStatus::kLost, FrameCause::kNothingFound},
               {"blur=15@6:9", FrameStatus::kLost, FrameCause::kNothingFound},
               {"truncated@6:9", FrameStatus::kRejected, FrameCause::kUnusable},
               {"one_eyed@6:9", FrameStatus::kRejected, FrameCause::kFailed}};
  for (const auto& [faults, status, cause] : cases) {
    const RunFolder folder = inject("faults", faults);
    for (std::size_t frame = 6; frame < 9; ++frame) expectFrame(folder, frame, status, cause);
    expectFrame(folder, 9, FrameStatus::kGood, FrameCause::kAfterGap);
    expectFrame(folder, 10, FrameStatus::kGood, FrameCause::kNone);
    EXPECT_EQ(folder.frames.back().head.segment, 0) << faults;
    EXPECT_LT(drift_m("faults"), 1.5 * clean_m + 0.01) << faults;
  }
  EXPECT_EQ(summary("faults")["frames"]["by_cause"]["failed"], 3);
  EXPECT_EQ(summary("faults")["frames"]["degraded"], 1);
}

TEST_F(Inject, AStartInTheDarkIsNoMotion) {
  const RunFolder folder = inject("dark", "black@0:4");
  for (std::size_t frame = 0; frame < 5; ++frame)
    EXPECT_LT(folder.online.camera[frame].translation().norm(), 1e-9) << frame;
  expectFrame(folder, 4, FrameStatus::kGood, FrameCause::kNone);
  expectFrame(folder, 6, FrameStatus::kGood, FrameCause::kNone);
}

TEST_F(Inject, AJumpOfTheClockBeginsANewSegment) {
  const RunFolder folder = inject("jump", "jump=3600@7");
  expectFrame(folder, 7, FrameStatus::kRejected, FrameCause::kOutOfOrder);  // it might have been one wrong time
  expectFrame(folder, 8, FrameStatus::kLost, FrameCause::kUnlinked);
  expectFrame(folder, 10, FrameStatus::kGood, FrameCause::kNone);
  EXPECT_EQ(folder.frames[7].head.segment, 0);
  EXPECT_EQ(folder.frames[10].head.segment, 1);
  EXPECT_LT((folder.final.camera[9].translation() - folder.final.camera[6].translation()).norm(), 40);
  EXPECT_EQ(summary("jump")["frames"]["segments"], 2);
  EXPECT_EQ(summary("jump")["inject"], "jump=3600@7");
  EXPECT_EQ(evaluate("jump")["frames"], kFrames) << "measured, although most times are not the sequence's";
  for (const auto& row : folder.final.objects) {
    for (const auto& other : folder.final.objects) {
      const bool across = row.frame < FrameId{7} && other.frame > FrameId{7};
      EXPECT_FALSE(across && row.object.track == other.object.track) << row.object.track.value;
    }
  }
}

TEST_F(Inject, AClockThatIsSetBackCostsAFewFrames) {
  const RunFolder folder = inject("back", "jump=-3600@4");
  for (std::size_t frame = 4; frame < 8; ++frame)
    expectFrame(folder, frame, FrameStatus::kRejected, FrameCause::kOutOfOrder);
  expectFrame(folder, 8, FrameStatus::kGood, FrameCause::kAfterGap);
  expectFrame(folder, 9, FrameStatus::kGood, FrameCause::kNone);
  EXPECT_THAT(contentOf(errors()), HasSubstr("frame 8: the clock of the camera was set back"));
}

TEST_F(Inject, OneTimeFarAheadCostsAFrame) {
  const RunFolder folder = inject("ahead", "jump=3600@6,jump=-3600@7");
  expectFrame(folder, 6, FrameStatus::kRejected, FrameCause::kOutOfOrder);
  expectFrame(folder, 7, FrameStatus::kGood, FrameCause::kAfterGap);
  expectFrame(folder, 8, FrameStatus::kGood, FrameCause::kNone);
}

TEST_F(Inject, LatePairsAreIgnored) {
  const RunFolder folder = inject("late", "reordered@6,late=3@13");
  expectFrame(folder, 6, FrameStatus::kDropped, FrameCause::kTooLate);
  expectFrame(folder, 13, FrameStatus::kDropped, FrameCause::kTooLate);
  EXPECT_EQ(summary("late")["frames"]["late"], 2);
}

TEST_F(Inject, AFullDiskAndABadSpecificationEndTheRun) {
  EXPECT_EQ(run("full", "--inject disk=2@5"), 4);
  EXPECT_EQ(run("bad", "--inject blak@3"), 2);
  EXPECT_THAT(contentOf(errors()), HasSubstr("blak is no fault"));
}

TEST_F(Inject, ASlowDiskDelaysAReplayAndChangesNothing) {
  ASSERT_EQ(run("quick"), 0);
  inject("slow", "disk_stall=2@1");
  EXPECT_EQ(summary("slow")["frames"]["dropped"], 0);
  EXPECT_LE(summary("slow")["writing"]["high_water"], summary("slow")["writing"]["bound"]);
  EXPECT_GE(summary("slow")["wall_s"].get<double>(), 2);
  expectSame("quick", "slow");
}

/// The disk stalls for longer than the rest of the drive takes: whatever comes out meanwhile did not wait for it.
TEST_F(Inject, AStalledDiskHoldsUpNoFrameOfALiveRun) {
  constexpr double kStall_s = 4;
  ASSERT_EQ(run("stalled", "--live --rate 10 --inject disk_stall=4@1"), 0) << contentOf(errors());
  const RunFolder folder = readRunFolder(out("stalled"));
  ASSERT_EQ(folder.frames.size(), kFrames);
  for (const FrameRow& frame : folder.frames) EXPECT_LT(frame.latency_ms, 1e3 * kStall_s) << frame.head.frame.value;
  const auto told = summary("stalled");
  EXPECT_GE(told["writing"]["high_water"].get<int>() + 1, told["frames"]["processed"].get<int>())
      << "all but the first waited";
  EXPECT_EQ(told["writing"]["waits"], 0);
}

}  // namespace
}  // namespace motorcade::test
