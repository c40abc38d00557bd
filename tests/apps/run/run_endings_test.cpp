#include <sstream>
#include <string>

#include <gmock/gmock.h>

#include "io/results/run_folder.hpp"
#include "tests/apps/program_run.hpp"

/// Tests how `motorcade run` ends when something else ends it, and what it leaves.
namespace motorcade::test {
namespace {

using testing::HasSubstr;

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
  EXPECT_EQ(run("INT"), 0) << "what did not come to its end is replaced unasked";
}

/// Every back-end leaves the finals of what is older than the lag; a filter has no lag.
TEST_F(Run, LeavesFinalsWhenItIsKilled) {
  constexpr std::size_t kLag_frames = 3, kWritten = 8;
  for (const std::string backend : {"joint", "pose_graph", "filter", "filter_map"}) {
    SCOPED_TRACE(backend);
    std::ostringstream killed;
    killed << MOTORCADE_PROGRAM << " run " << kSequence << " --out " << out(backend)
           << " --rate 5 --set backend.kind=" << backend << " --set backend.settling_s=0.25 >/dev/null 2>&1 & ";
    killed << waitForLines(out(backend) / "camera_online.txt", kWritten - 1) << "kill -KILL $!; wait";
    ASSERT_EQ(std::system(killed.str().c_str()), 0);
    const RunFolder folder = readRunFolder(out(backend));
    EXPECT_FALSE(folder.complete());
    EXPECT_GE(folder.online.camera.size(), kWritten);
    EXPECT_LT(folder.online.camera.size(), kFrames);
    EXPECT_GE(folder.final.camera.size() + kLag_frames + 1, folder.online.camera.size());
    EXPECT_FALSE(folder.final.objects.empty());
    const auto measures = evaluate(backend);
    EXPECT_EQ(measures["final"]["frames"], folder.online.camera.size());
    EXPECT_EQ(measures["finals_recovered"], folder.online.camera.size() - folder.final.camera.size());
    EXPECT_LT(measures["final"]["camera"]["ate_m"]["rmse"], 0.1);
  }
}

/// Settled estimates are of the same frames as the final ones, and nearly the same.
TEST_F(Run, SettledEstimatesDoNotChangeTheFinalOnes) {
  ASSERT_EQ(run("late"), 0);
  ASSERT_EQ(run("early", "--set backend.settling_s=0.2"), 0);
  expectSame("late", "early");
}

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kReservesAddresses = true;  // far more than any limit here
#else
constexpr bool kReservesAddresses = false;
#endif

/// The limits begin where the program hardly starts (its shared libraries alone take over 50 MB of addresses) and end
/// where it has enough.
TEST_F(Run, EndsWithAMessageWhereMemoryRunsOut) {
  if (kReservesAddresses) GTEST_SKIP() << "sanitizers reserve address space";
  constexpr int kLeast_mb = 70, kMost_mb = 350, kStep_mb = 10;
  int short_of_memory = 0;
  for (int limit_mb = kLeast_mb; limit_mb <= kMost_mb; limit_mb += kStep_mb) {
    SCOPED_TRACE(std::to_string(limit_mb) + " MB");
    const int code = motorcade("run " + kSequence.string() + " --force --out " + out("small").string(),
                               "ulimit -c 0; ulimit -v " + std::to_string(1024 * limit_mb) + "; timeout 60 ");
    EXPECT_THAT(code, testing::AnyOf(0, 3, 4, 70)) << contentOf(errors());
    if (code == 0) continue;
    ++short_of_memory;
    EXPECT_THAT(contentOf(errors()), testing::AnyOf(HasSubstr("out of memory"), HasSubstr("error"))) << code;
  }
  EXPECT_GT(short_of_memory, 2);
}

}  // namespace
}  // namespace motorcade::test
