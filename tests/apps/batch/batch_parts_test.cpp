#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/batch/local_runner.hpp"
#include "apps/batch/slurm.hpp"
#include "apps/batch/time_left.hpp"
#include "io/files/errors.hpp"

namespace motorcade {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;

TEST(ProcessorSlots, EachTaskHasProcessorsOfItsOwn) {
  const auto slots = processorSlots({1, 2, 5, 7, 9}, 2, 2);
  EXPECT_THAT(slots, ElementsAre(ElementsAre(1, 2), ElementsAre(5, 7)));
}

TEST(ProcessorSlots, WithTooFewProcessorsNoTaskIsKeptToAny) {
  EXPECT_THAT(processorSlots({0, 1}, 2, 2), ElementsAre(ElementsAre(), ElementsAre()));
}

TEST(TaskTime, TakesSlurmsForms) {
  EXPECT_EQ(taskTime(""), 0s);
  EXPECT_EQ(taskTime("90"), 90min);
  EXPECT_EQ(taskTime("2:30"), 150s);
  EXPECT_EQ(taskTime("1:02:03"), 1h + 2min + 3s);
  EXPECT_EQ(taskTime("2-3"), 51h);
  EXPECT_EQ(taskTime("1-0:30"), 24h + 30min);
  EXPECT_EQ(taskTime("1-1:1:1"), 25h + 61s);
  for (const char* const wrong : {"x", "1:2:3:4", "-5", "1-", "0", ":", "1.5"})
    EXPECT_THROW(taskTime(wrong), UsageError) << wrong;
}

TEST(DurationText, IsShort) {
  EXPECT_EQ(durationText(41.4), "41 s");
  EXPECT_EQ(durationText(185), "3 min");
  EXPECT_EQ(durationText(2 * 3600 + 5 * 60 + 1), "2 h 5 min");
}

/// A scene of two sets, and a recorded drive.
class QueueOfThree : public testing::Test {
 protected:
  Task scene_a_{.name = "scene.a", .sequence = "/nowhere/scene", .render_arguments = {"--scene", "lead"}};
  Task scene_b_{.name = "scene.b", .sequence = "/nowhere/scene", .render_arguments = {"--scene", "lead"}};
  Task drive_{.name = "drive.a", .sequence = "/nowhere/drive"};
  TaskQueue queue_{{&scene_a_, &scene_b_, &drive_}};
};

TEST_F(QueueOfThree, ASceneIsRenderedOnceAndItsTasksWaitForIt) {
  const auto render = queue_.next();
  ASSERT_TRUE(render && render->only_render);
  const auto other = queue_.next();
  ASSERT_TRUE(other);
  EXPECT_EQ(other->task, &drive_);
  std::optional<TaskQueue::Item> waited;
  std::jthread worker([&] { waited = queue_.next(); });
  queue_.done(*render);
  worker.join();
  ASSERT_TRUE(waited);
  EXPECT_EQ(waited->task, &scene_a_);
  EXPECT_EQ(queue_.next()->task, &scene_b_);
  EXPECT_FALSE(queue_.next());
}

TEST_F(QueueOfThree, WhoWaitsIsSetFreeWhenTheQueueIsStopped) {
  queue_.next();
  queue_.next();
  std::optional<TaskQueue::Item> waited;
  std::jthread worker([&] { waited = queue_.next(); });
  queue_.stop();
  worker.join();
  EXPECT_FALSE(waited);
}

TEST(SlurmScript, AsksForCoresMemoryAndTimeAndGoesOnAfterTheLossOfANode) {
  const SlurmScripts scripts{.program = "/opt/it's/motorcade",
                             .batch = "/data/batch",
                             .submission = "/data/batch/cluster/1",
                             .threads = 3,
                             .options = {.partition = "fast", .time = "1:00:00", .array_limit = 7, .memory_mb = 900}};
  const std::string text =
      scripts.array({.name = "tasks-1", .list = "/data/batch/cluster/1/tasks.txt", .first = 1001, .count = 20});
  for (const char* const line :
       {"#SBATCH --array=0-19%7\n", "--cpus-per-task=3\n", "#SBATCH --mem=900M\n", "#SBATCH --time=1:00:00\n",
        "#SBATCH --partition=fast\n", "#SBATCH --requeue\n", "#SBATCH --output=/data/batch/cluster/1/tasks-1_%a.log\n",
        "exec '/opt/it'\\''s/motorcade' batch task '/data/batch' --list '/data/batch/cluster/1/tasks.txt' --index",
        " --index $((1001 + SLURM_ARRAY_TASK_ID))\n"})
    EXPECT_THAT(text, HasSubstr(line));
}

TEST(SlurmScript, FoldersThatAScriptCannotNameAreRefused) {
  EXPECT_THROW(requireWritableInScript("/data/my batch"), UsageError);
  EXPECT_THROW(requireWritableInScript("/data/100%"), UsageError);
  EXPECT_NO_THROW(requireWritableInScript("/data/batch-1_a.b"));
}

}  // namespace
}  // namespace motorcade
