#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "motorcade/motorcade.h"
#include "tests/interface/c_drive.hpp"
#include "tests/interface/c_handles.hpp"

namespace motorcade {
namespace {

using test::cameraOf;
using test::openDrive;
using test::replayOptions;
using test::sized;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::StartsWith;

/// Lines of the log, which come from several threads.
struct Log {
  std::mutex mutex;
  std::vector<std::string> lines;

  static void write(motorcade_log_level level, const char* text, void* user) {
    auto& log = *static_cast<Log*>(user);
    const std::scoped_lock lock(log.mutex);
    log.lines.push_back(std::to_string(level) + " " + text);
  }
};

TEST(CInterfaceLog, TellsThatTheClockWasSetBack) {
  Log log;
  auto options = replayOptions();
  options.log = Log::write;
  options.log_user = &log;
  const auto drive = openDrive();
  auto tracker = test::trackerOf(cameraOf(drive.get()), &options);
  auto pair = sized<motorcade_pair>();
  auto push = sized<motorcade_push>();
  for (std::int64_t i = 0; motorcade_recording_read(drive.get(), i, &pair) == MOTORCADE_OK; ++i) {
    if (i < 5) pair.stamp_ns += 3'600'000'000'000;  // an hour later, and back
    motorcade_tracker_push(tracker.get(), &pair, &push);
  }
  motorcade_tracker_close(tracker.get());
  while (test::taken(tracker.get())) {
  }
  tracker.reset();  // from here on nobody writes
  EXPECT_THAT(log.lines, Contains(AllOf(StartsWith("1 frame "), HasSubstr("set back"))));
}

}  // namespace
}  // namespace motorcade
