#include "apps/run/mcap_recorder.hpp"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>

#include <gmock/gmock.h>
#include <sys/resource.h>

#include "io/files/errors.hpp"
#include "tests/apps/export/mcap_reading.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

constexpr StereoCamera kCamera{300, 300, 160, 60, 0.5, 320, 120};

class McapRecorderFile : public testing::Test {
 protected:
  StereoFrame pair(int index) {
    StereoFrame frame;
    frame.head.frame = {index};
    frame.head.stamp = stampOf(index);
    frame.left = pool_.acquire(kCamera.width_px, kCamera.height_px);
    for (int y = 0; y < kCamera.height_px; ++y)
      std::fill_n(frame.left.mutableRow(y), kCamera.width_px, std::uint8_t{9});
    return frame;
  }
  static PipelineResult result(int index) {
    PipelineResult result;
    result.online.head.frame = {index};
    result.online.head.stamp = stampOf(index);
    return result;
  }
  std::size_t count(const char* topic) {
    const auto content = test::readMcap(folder_.read("run.mcap"));
    const auto found = content.messages.find(topic);
    return found == content.messages.end() ? 0 : found->second.size();
  }
  static Timestamp stampOf(int index) { return {std::int64_t{10'000'000} * index}; }

  ImagePool pool_;
  test::TemporaryFolder folder_;
};

TEST_F(McapRecorderFile, AReplayWaitsAndLosesNothing) {
  McapRecorder recorder(folder_ / "run.mcap", kCamera, McapRecorder::Behind::kWait);
  for (int i = 0; i < 200; ++i) {
    recorder.frameEntered(pair(i));
    recorder.frameLeft(result(i));
  }
  recorder.close();
  EXPECT_EQ(recorder.leftOut().images + recorder.leftOut().frames, 0);
  EXPECT_EQ(count("/camera/left/compressed"), 200U);
  EXPECT_EQ(count("/diagnostics"), 200U);
}

TEST_F(McapRecorderFile, ALiveRunNeverWaitsAndCountsWhatIsLeftOut) {
  constexpr int kFrames = 500;
  McapRecorder recorder(folder_ / "run.mcap", kCamera, McapRecorder::Behind::kLeaveOut);
  for (int i = 0; i < kFrames; ++i) {
    recorder.frameEntered(pair(i));
    recorder.frameLeft(result(i));
  }
  recorder.close();
  const auto [images, frames] = recorder.leftOut();
  EXPECT_EQ(count("/diagnostics") + frames, static_cast<std::size_t>(kFrames));
  EXPECT_EQ(count("/camera/left/compressed") + images + frames, static_cast<std::size_t>(kFrames));
}

TEST_F(McapRecorderFile, HoldsFewImagesOfFramesWhoseResultNeverComes) {
  McapRecorder recorder(folder_ / "run.mcap", kCamera, McapRecorder::Behind::kLeaveOut);
  for (int i = 0; i < 300; ++i) recorder.frameEntered(pair(i));
  EXPECT_LE(pool_.buffersMade(), 34U);
}

TEST_F(McapRecorderFile, AResultMayOvertakeTheNewsOfItsPair) {
  McapRecorder recorder(folder_ / "run.mcap", kCamera, McapRecorder::Behind::kWait);
  recorder.frameLeft(result(0));
  recorder.frameEntered(pair(0));
  recorder.close();
  EXPECT_EQ(count("/camera/left/compressed"), 1U);
}

TEST_F(McapRecorderFile, AFullDiskEndsTheRunWithTheFilesName) {
  // Not a disk, but the limit of a file's size, stands for it.
  const auto run = [&] {
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit limit{4096, RLIM_INFINITY};
    setrlimit(RLIMIT_FSIZE, &limit);
    McapRecorder recorder(folder_ / "run.mcap", kCamera, McapRecorder::Behind::kWait);
    try {
      for (int i = 0; i < 1000; ++i) {
        recorder.frameEntered(pair(i));
        recorder.frameLeft(result(i));
      }
    } catch (const OutputError& error) {
      std::fputs(error.what(), stderr);
      std::exit(error.exitCode());
    }
    std::exit(0);
  };
  EXPECT_EXIT(run(), testing::ExitedWithCode(4), "run.mcap: cannot be written");
}

}  // namespace
}  // namespace motorcade
