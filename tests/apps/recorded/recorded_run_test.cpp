#include "apps/recorded/recorded_run.hpp"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/files/errors.hpp"
#include "io/images/image_file.hpp"
#include "tests/io/temporary_folder.hpp"
#include "tests/support/matchers.hpp"

namespace motorcade {
namespace {

using test::messageOf;
using testing::AllOf;
using testing::HasSubstr;

constexpr std::int64_t kPeriod_ns = 100'000'000;

Sequence sequenceOf(std::size_t frames, std::int64_t period_ns = kPeriod_ns) {
  Sequence sequence;
  sequence.folder = "drive";
  sequence.frames.resize(frames);
  for (std::size_t i = 0; i < frames; ++i) sequence.stamps.push_back({static_cast<std::int64_t>(i) * period_ns});
  sequence.stamps_measured = true;
  return sequence;
}

RunFolder runOf(std::int64_t first, std::int64_t end) {
  RunFolder run{.folder = "run", .first_frame = first, .summary_json = R"({"complete": true, "inject": ""})"};
  for (std::int64_t frame = first; frame < end; ++frame) {
    run.frames.push_back({.head = {.frame = {frame}, .stamp = {frame * kPeriod_ns}}});
    run.online.camera.emplace_back();
  }
  return run;
}

TEST(RequireSameDrive, AcceptsPartOfTheDrive) {
  requireSameDrive(runOf(0, 20), sequenceOf(20));
  requireSameDrive(runOf(7, 12), sequenceOf(20));
  requireSameDrive(runOf(0, 0), sequenceOf(20));
}

TEST(RequireSameDrive, RefusesFramesBeyondTheEnd) {
  EXPECT_THAT(messageOf<InputError>([] { requireSameDrive(runOf(0, 21), sequenceOf(20)); }),
              AllOf(HasSubstr("run: is no run of drive"), HasSubstr("up to 20"), HasSubstr("has 20")));
  RunFolder without_table = runOf(0, 21);
  without_table.frames.clear();
  EXPECT_THROW(requireSameDrive(without_table, sequenceOf(20)), InputError);
}

TEST(RequireSameDrive, RefusesOtherTimes) {
  EXPECT_THAT(messageOf<InputError>([] { requireSameDrive(runOf(0, 20), sequenceOf(20, 2 * kPeriod_ns)); }),
              AllOf(HasSubstr("run: is no run of drive"), HasSubstr("other times")));
  Sequence at_assumed_rate = sequenceOf(20, 2 * kPeriod_ns);
  at_assumed_rate.stamps_measured = false;
  EXPECT_THAT(messageOf<InputError>([&] { requireSameDrive(runOf(0, 20), at_assumed_rate); }), HasSubstr("--fps"));
}

TEST(RequireSameDrive, AcceptsTimesThatAreOffByLessThanHalfAPeriodOrInFewFrames) {
  RunFolder run = runOf(0, 20);
  for (auto& row : run.frames) row.head.stamp.ns += 49 * kPeriod_ns / 100;
  for (std::size_t frame = 0; frame < 9; ++frame) run.frames[frame].head.stamp.ns += 5 * kPeriod_ns;
  requireSameDrive(run, sequenceOf(20));
  for (auto& row : run.frames) row.head.stamp.ns += 2 * kPeriod_ns / 100;
  EXPECT_THROW(requireSameDrive(run, sequenceOf(20)), InputError);
}

TEST(RequireSameDrive, BelievesNoTimesThatFaultsChangedOrThatNoSummaryTellsOf) {
  RunFolder run = runOf(0, 20);
  for (auto& row : run.frames) row.head.stamp.ns += 60 * kPeriod_ns;
  EXPECT_THROW(requireSameDrive(run, sequenceOf(20)), InputError);
  run.summary_json = R"({"inject": "black@3,jump=6@0"})";
  requireSameDrive(run, sequenceOf(20));
  run.summary_json.clear();
  requireSameDrive(run, sequenceOf(20));
}

/// A drive on the disk that has no times.
class OpenSequenceOf : public testing::Test {
 protected:
  OpenSequenceOf() {
    ImagePool pool;
    const Image image = pool.acquire(64, 32);
    for (const char* side : {"image_0", "image_1"}) {
      std::filesystem::create_directories(folder_ / "drive" / side);
      for (int i = 10; i < 15; ++i) writePng(folder_ / "drive" / side / (std::to_string(i) + ".png"), image);
    }
    folder_.write("drive/calib.txt", "P0: 700 0 32 0 0 700 16 0 0 0 1 0\nP1: 700 0 32 -350 0 700 16 0 0 0 1 0\n");
    run_.folder = folder_ / "run";
  }

  test::TemporaryFolder folder_;
  RunFolder run_ = runOf(0, 5);
};

TEST_F(OpenSequenceOf, TakesFolderAndRateFromTheSummary) {
  for (auto& row : run_.frames) row.head.stamp.ns /= 2;
  run_.summary_json = R"({"capture_rate_hz": 20.0, "sequence": ")" + (folder_ / "drive").string() + "\"}";
  const Sequence sequence = openSequenceOf(run_, {});
  EXPECT_EQ(sequence.folder, folder_ / "drive");
  EXPECT_EQ(sequence.stamps[2].ns, kPeriod_ns);
  EXPECT_THROW(openSequenceOf(run_, {.fps_hz = 10}), InputError);
}

TEST_F(OpenSequenceOf, PrefersWhatTheUserSays) {
  run_.summary_json = R"({"sequence": "elsewhere"})";
  EXPECT_EQ(openSequenceOf(run_, {.folder = folder_ / "drive"}).folder, folder_ / "drive");
}

TEST_F(OpenSequenceOf, NamesWhatIsMissing) {
  const auto message = [&] { return messageOf<InputError>([&] { openSequenceOf(run_, {}); }); };
  run_.summary_json.clear();
  EXPECT_THAT(message(), AllOf(HasSubstr("run/summary.json: is not there"), HasSubstr("--sequence")));
  for (const char* const useless : {"{}", "no JSON", "[3]", R"({"sequence": 3})"}) {
    run_.summary_json = useless;
    EXPECT_THAT(message(), AllOf(HasSubstr("run/summary.json: does not name"), HasSubstr("--sequence"))) << useless;
  }
  run_.summary_json = R"({"sequence": "elsewhere"})";
  EXPECT_THAT(message(), AllOf(HasSubstr("elsewhere, which is not there"), HasSubstr("--sequence")));
}

TEST(HoldsFinishedRun, WhereASummarySaysSoOrSaysNothing) {
  const test::TemporaryFolder folder;
  EXPECT_FALSE(holdsFinishedRun(folder / "nowhere"));
  folder.write("camera_online.txt", "");
  EXPECT_FALSE(holdsFinishedRun(folder.path()));
  folder.write("summary.json", R"({"complete": false})");
  EXPECT_FALSE(holdsFinishedRun(folder.path())) << "interrupted";
  for (const char* const summary : {R"({"complete": true})", "{}", "no JSON"}) {
    folder.write("summary.json", summary);
    EXPECT_TRUE(holdsFinishedRun(folder.path())) << summary;
  }
}

using test::IsNearPose;

RunFolder::ObjectRow rowOf(std::int64_t frame, std::int64_t track, const SE3& T_world_body) {
  RunFolder::ObjectRow row{.frame = {frame}, .object = {}};
  row.object.track = {track};
  row.object.T_world_body = T_world_body;
  row.object.velocity_world_mps = {0, 0, 10};
  return row;
}

SE3 at(double x_m, double z_m) { return SE3(Eigen::Matrix3d::Identity(), {x_m, 0, z_m}); }

TEST(RecoveredFinals, GoOnFromTheLastFinalPose) {
  RunFolder run{.first_frame = 10};
  run.online.camera = {at(0, 0), at(0, 1), at(0, 2), at(0, 3)};
  const Eigen::Matrix3d turn = SE3::exp((Vector6d() << 0, 0, 0, 0, 0.1, 0).finished()).rotation();
  run.final.camera = {at(0, 0), SE3(turn, {0.5, 0, 1})};
  for (std::int64_t frame = 10; frame < 15; ++frame) run.online.objects.push_back(rowOf(frame, 1, at(2, 20)));
  run.final.objects = {rowOf(10, 1, at(2.5, 20)), rowOf(11, 1, at(2.5, 20)), rowOf(12, 1, at(9, 9))};

  EXPECT_EQ(recoverFinals(run), 2u);
  ASSERT_EQ(run.final.camera.size(), 4u);
  EXPECT_THAT(run.final.camera[1].inverse() * run.final.camera[3], IsNearPose(at(0, 2), 1e-12));
  ASSERT_EQ(run.final.objects.size(), 4u) << "without the row of a frame that is not final, and one without a pose";
  EXPECT_THAT(run.final.camera[2].inverse() * run.final.objects[2].object.T_world_body, IsNearPose(at(2, 18), 1e-12));
  EXPECT_NEAR((run.final.objects[2].object.velocity_world_mps - turn * Eigen::Vector3d(0, 0, 10)).norm(), 0, 1e-12);
  EXPECT_EQ(run.final.objects[3].frame.value, 13);
}

TEST(RecoveredFinals, LeaveAWholeRunAlone) {
  RunFolder run;
  run.online.camera = run.final.camera = {at(0, 0), at(0, 1)};
  run.final.objects = {rowOf(1, 1, at(2, 20))};
  EXPECT_EQ(recoverFinals(run), 0u);
  EXPECT_EQ(run.final.objects.size(), 1u);
}

TEST(RecoveredFinals, WithoutAnyFinalAllAreOnline) {
  RunFolder run;
  run.online.camera = {at(0, 0), at(0, 1)};
  run.online.objects = {rowOf(1, 1, at(2, 20))};
  EXPECT_EQ(recoverFinals(run), 2u);
  EXPECT_EQ(run.final.camera.size(), 2u);
  EXPECT_EQ(run.final.objects.size(), 1u);
}

}  // namespace
}  // namespace motorcade
