#include "apps/tasks/task_performer.hpp"

#include <csignal>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>

#include "apps/console/child_process.hpp"
#include "apps/tasks/fingerprint.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using test::contentOf;
namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::HasSubstr;

/// Performs tasks with a program that is a script of the test.
class Performer : public testing::Test {
 protected:
  Performer() : folder_(root_ / "batch") {
    task_ = {.name = "drive.set",
             .drive = "drive",
             .set = "set",
             .sequence = root_ / "sequence",
             .run_arguments = {"--threads", "1"},
             .has_truth = true,
             .fingerprint = "f"};
  }

  Workplace workplace(const std::string& script, const std::string& attempt = "me") {
    const fs::path program = root_ / "program";
    std::ofstream(program) << "#!/bin/sh\n" << script << "\n";
    fs::permissions(program, fs::perms::owner_all);
    return {.folder = folder_, .program = program, .program_stamp = fileStamp(program), .attempt = attempt};
  }

  const test::TemporaryFolder root_;
  BatchFolder folder_;
  Task task_;
};

TEST_F(Performer, RunsAndEvaluatesInAFolderOfItsOwnThatBecomesTheResult) {
  const auto record = performTask(task_, workplace("echo \"$@\"; mkdir -p run; pwd > where"));
  ASSERT_TRUE(record);
  EXPECT_FALSE(record->failure);
  const fs::path result = folder_.result("drive.set");
  EXPECT_EQ(contentOf(logIn(result)),
            "run " + task_.sequence.string() + " --out run --threads 1\nevaluate run --json evaluation.json\n");
  EXPECT_EQ(contentOf(result / "where"), (folder_.attempts() / "drive.set~me").string() + "\n");
  EXPECT_TRUE(fs::is_empty(folder_.attempts()));
  EXPECT_EQ(readTaskRecord(recordIn(result)).fingerprint, "f");
}

TEST_F(Performer, WithoutTruthNothingIsEvaluated) {
  task_.has_truth = false;
  ASSERT_TRUE(performTask(task_, workplace("echo \"$1\"")));
  EXPECT_EQ(contentOf(logIn(folder_.result("drive.set"))), "run\n");
}

TEST_F(Performer, WhatFailsIsKeptWithItsLastLines) {
  const auto record = performTask(task_, workplace("for i in $(seq 20); do echo line $i; done; exit 3"));
  ASSERT_TRUE(record && record->failure);
  EXPECT_EQ(record->failure->step, "run");
  EXPECT_EQ(record->failure->exit_code, 3);
  EXPECT_EQ(record->failure->last_lines.back(), "line 20");
  EXPECT_EQ(record->failure->last_lines.size(), 8U);
  EXPECT_FALSE(fs::exists(folder_.result("drive.set")));
  EXPECT_TRUE(failedRecord(task_, folder_));
}

TEST_F(Performer, ASuccessTakesAwayAnEarlierFailure) {
  performTask(task_, workplace("exit 1"));
  performTask(task_, workplace("true"));
  EXPECT_FALSE(failedRecord(task_, folder_));
  EXPECT_TRUE(finishedRecord(task_, folder_));
}

TEST_F(Performer, AKilledStepIsAFailureThatNamesTheSignal) {
  const auto record = performTask(task_, workplace("kill -KILL $$"));
  ASSERT_TRUE(record && record->failure);
  EXPECT_EQ(record->failure->signal, SIGKILL);
  EXPECT_THAT(record->failure->message, HasSubstr("killed"));
}

TEST_F(Performer, AStepThatTakesTooLongIsEnded) {
  auto place = workplace("sleep 60");
  place.limit = 1s;
  const auto record = performTask(task_, place);
  ASSERT_TRUE(record && record->failure);
  EXPECT_THAT(record->failure->message, HasSubstr("longer than the 1 s"));
  EXPECT_LT(record->wall_s, 30);
}

TEST_F(Performer, WhatWasStoppedLeavesNothing) {
  std::atomic<bool> stop = false;
  auto place = workplace("touch " + (root_ / "started").string() + "; sleep 60");
  place.stop = &stop;
  std::jthread stopper([&] {
    while (!fs::exists(root_ / "started")) std::this_thread::sleep_for(10ms);
    stop = true;
  });
  EXPECT_FALSE(performTask(task_, place));
  EXPECT_TRUE(fs::is_empty(folder_.attempts()));
  EXPECT_FALSE(fs::exists(folder_.failure("drive.set")));
}

TEST_F(Performer, TwoAttemptsAtTheSameTimeDoNoHarm) {
  const auto place = workplace("mkdir -p run; echo \"$1\" > run/step; sleep 0.2"), other = [&] {
    auto second = place;
    second.attempt = "other";
    return second;
  }();
  {
    std::jthread second([&] { performTask(task_, other); });
    performTask(task_, place);
  }
  EXPECT_TRUE(finishedRecord(task_, folder_));
  EXPECT_EQ(contentOf(folder_.result("drive.set") / "run" / "step"), "evaluate\n");
  EXPECT_TRUE(fs::is_empty(folder_.attempts()));
}

TEST_F(Performer, AFinishedTaskCountsForTheSameFingerprintOnly) {
  performTask(task_, workplace("true"));
  EXPECT_TRUE(finishedRecord(task_, folder_));
  task_.fingerprint = "g";
  EXPECT_FALSE(finishedRecord(task_, folder_));
}

TEST_F(Performer, AChangedProgramIsNotRun) {
  auto place = workplace("touch " + (root_ / "ran").string());
  place.program_stamp = "another";
  const auto record = performTask(task_, place);
  ASSERT_TRUE(record && record->failure);
  EXPECT_THAT(record->failure->message, HasSubstr("was changed since"));
  EXPECT_FALSE(fs::exists(root_ / "ran"));
}

TEST_F(Performer, ASceneIsRenderedOnceAndBelongsToItsResults) {
  task_.render_arguments = {"--scene", "lead"};
  const auto place =
      workplace("[ $1 = synth ] && echo x >> " + (root_ / "rendered").string() + " && touch poses.txt; true");
  performTask(task_, place);
  EXPECT_TRUE(finishedRecord(task_, folder_));
  Task other = task_;
  other.name = "drive.other";
  performTask(other, place);
  EXPECT_EQ(contentOf(root_ / "rendered"), "x\n");
  std::ofstream(task_.sequence / "poses.txt") << "rendered anew";
  EXPECT_FALSE(finishedRecord(task_, folder_));
  fs::remove_all(task_.sequence);  // given up to save space: results stay
  EXPECT_TRUE(finishedRecord(task_, folder_));
}

TEST_F(Performer, AFailedRenderingIsToldByTheTask) {
  task_.render_arguments = {"--scene", "lead"};
  const auto record = performTask(task_, workplace("[ $1 = synth ] && echo no room && exit 4"));
  ASSERT_TRUE(record && record->failure);
  EXPECT_EQ(record->failure->step, "synth");
  EXPECT_THAT(record->failure->last_lines, testing::ElementsAre("no room"));
  EXPECT_FALSE(fs::exists(task_.sequence));
}

TEST_F(Performer, AChildIsKeptToItsProcessors) {
  cpu_set_t usable;
  ASSERT_EQ(sched_getaffinity(0, sizeof usable, &usable), 0);
  int last = 0;
  for (int processor = 0; processor < CPU_SETSIZE; ++processor)
    if (CPU_ISSET(static_cast<std::size_t>(processor), &usable)) last = processor;
  auto place = workplace("grep Cpus_allowed_list /proc/self/status");
  place.processors = {last};
  performTask(task_, place);
  EXPECT_THAT(contentOf(logIn(folder_.result("drive.set"))), HasSubstr("list:\t" + std::to_string(last) + "\n"));
}

TEST_F(Performer, AProgramThatIsNotThereEndsWith127) {
  ChildProcess child({.words = {(root_ / "nothing").string()}, .folder = root_.path(), .log = root_ / "log"});
  const auto end = child.wait(10s);
  ASSERT_TRUE(end);
  EXPECT_EQ(end->exit_code, 127);
  EXPECT_THAT(contentOf(root_ / "log"), HasSubstr("cannot be executed: No such file"));
}

TEST_F(Performer, ADestroyedChildIsKilled) {
  int process = 0;
  {
    const ChildProcess child(
        {.words = {"/bin/sh", "-c", "echo $$ > pid; exec sleep 60"}, .folder = root_.path(), .log = root_ / "log"});
    while (process == 0) std::ifstream(root_ / "pid") >> process;
  }
  EXPECT_NE(::kill(process, 0), 0);
}

}  // namespace
}  // namespace motorcade
