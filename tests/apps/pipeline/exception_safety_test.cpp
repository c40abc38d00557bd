#include <algorithm>
#include <atomic>
#include <new>
#include <numeric>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "apps/pipeline/configuration.hpp"
#include "apps/pipeline/pipeline.hpp"
#include "tests/apps/rendered_drive.hpp"
#include "tests/support/replaced_heap.hpp"

/// Refuses one allocation of a frame, each in turn, on a short rendered drive behind a car that the build's test
/// fixture makes. A program of its own, so that the replaced heap reaches no other test.
namespace {

// The n-th allocation from now on is refused, on any thread but the test's own; far away when none is to be.
constexpr long kNever = 1'000'000'000;
std::atomic<long> until_refused{kNever};
thread_local bool own_thread = false;
std::atomic<long> blocks_in_use{0};

}  // namespace

bool heapTaken() {
  const bool given = own_thread || until_refused.fetch_sub(1, std::memory_order_relaxed) != 1;
  if (given) blocks_in_use.fetch_add(1, std::memory_order_relaxed);
  return given;
}
void heapGiven() { blocks_in_use.fetch_sub(1, std::memory_order_relaxed); }

namespace motorcade {
namespace {

constexpr std::size_t kBroken = 9;  // the frame that lacks memory; the car ahead is followed by then

/// Outcome of a drive on which an allocation was refused.
struct Trial {
  std::vector<PipelineResult> results;
  PipelineEnd end;
  bool ended_early = false;  // `finish` threw that there is no memory
  long allocations = 0;      // while the pipeline had the frame
};

/// Drives frame by frame, so that the refused allocation belongs to one frame.
Trial driveRefusing(long refused, const Drive& drive, const PipelineConfig& config) {
  Trial trial;
  Pipeline pipeline(config.pipeline, makeStages(config, drive.camera));
  for (std::size_t i = 0; i < drive.frames.size(); ++i) {
    if (i == kBroken) until_refused = refused;
    pipeline.push(drive.frames[i]);
    auto result = pipeline.next();
    if (i == kBroken) trial.allocations = refused - until_refused.exchange(kNever);
    if (!result) break;
    trial.results.push_back(*std::move(result));
  }
  try {
    trial.end = pipeline.finish();
  } catch (const std::bad_alloc&) {
    trial.ended_early = true;
  }
  return trial;
}

/// Number of allocations that are refused, one in each drive: the first ones of the frame, and some of the others.
struct Sample {
  std::string backend;
  long first, of_the_rest;
};

std::vector<long> allocationsToRefuse(long count, const Sample& sample) {
  std::vector<long> all(count);
  std::iota(all.begin(), all.end(), 1L);
  const auto rest = all.begin() + std::min(sample.first, count);
  std::shuffle(rest, all.end(), std::mt19937(17));
  all.resize(std::min(count, sample.first + sample.of_the_rest));
  return all;
}

/// Expects one output for each input: the frame may be lost, with a reason, and those after it are good.
void expectOneLostFrameAtMost(const Trial& trial, const Drive& drive) {
  ASSERT_EQ(trial.results.size(), drive.frames.size());
  std::size_t finals = trial.end.finals.size();
  for (std::size_t i = 0; i < trial.results.size(); ++i) {
    const PipelineResult& result = trial.results[i];
    finals += result.finals.size();
    EXPECT_EQ(result.online.head.frame.value, static_cast<std::int64_t>(i));
    EXPECT_TRUE(result.online.T_world_cam.translation().allFinite());
    EXPECT_TRUE(i == kBroken || result.problem.empty()) << i << ": " << result.problem;
    EXPECT_TRUE(i == kBroken || i == kBroken + 1 || result.online.head.status == FrameStatus::kGood) << i;
  }
  EXPECT_EQ(finals, drive.frames.size());
  const PipelineResult& broken = trial.results[kBroken];
  EXPECT_TRUE(broken.online.head.status == FrameStatus::kGood || !broken.problem.empty());
}

class ExceptionSafety : public testing::TestWithParam<Sample> {
 protected:
  ExceptionSafety() { own_thread = true; }
};

// The front-end is the same for all.
INSTANTIATE_TEST_SUITE_P(OfEachBackend, ExceptionSafety,
                         testing::Values(Sample{"joint", 300, 200}, Sample{"pose_graph", 0, 150},
                                         Sample{"filter", 0, 150}),
                         [](const auto& sample) { return sample.param.backend; });

TEST_P(ExceptionSafety, OneRefusedAllocationCostsOneFrameAtMost) {
  const Drive drive = readDrive(MOTORCADE_TINY_SEQUENCE);
  PipelineConfig config;
  applyAssignment(config, "backend.kind=" + GetParam().backend);
  config.pipeline = {.threads = 1, .frames_in_flight = 1};
  const Trial undisturbed = driveRefusing(kNever, drive, config);
  expectOneLostFrameAtMost(undisturbed, drive);

  const auto sample = allocationsToRefuse(undisturbed.allocations, GetParam());
  std::size_t lost = 0, ended_early = 0;
  for (const long refused : sample) {
    SCOPED_TRACE("allocation " + std::to_string(refused) + " of " + std::to_string(undisturbed.allocations));
    const long blocks_before = blocks_in_use;
    {
      const Trial trial = driveRefusing(refused, drive, config);
      ended_early += trial.ended_early;
      if (!trial.ended_early) expectOneLostFrameAtMost(trial, drive);
      if (HasFatalFailure()) return;
      lost += !trial.ended_early && !trial.results[kBroken].problem.empty();
    }
    EXPECT_EQ(blocks_in_use, blocks_before) << "memory was lost with the frame";
  }
  RecordProperty("allocations", static_cast<int>(undisturbed.allocations));
  RecordProperty("lost", static_cast<int>(lost));
  RecordProperty("ended_early", static_cast<int>(ended_early));
  EXPECT_GT(4 * lost, 3 * sample.size()) << "the heap refuses less than it should";
  // The pipeline's own few, to hand over what became of the frame: it ends, and says why.
  EXPECT_LT(20 * ended_early, sample.size());
}

}  // namespace
}  // namespace motorcade
