#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "motorcade/motorcade.h"
#include "tests/interface/c_handles.hpp"

namespace motorcade::test {

/// The rendered drive of these tests, read in C.
inline const std::string kDrive = MOTORCADE_TINY_SEQUENCE;

inline Owned<motorcade_recording> openDrive() {
  motorcade_recording* recording = nullptr;
  EXPECT_EQ(motorcade_recording_open(kDrive.c_str(), &recording), MOTORCADE_OK) << motorcade_last_error();
  return Owned<motorcade_recording>(recording);
}

inline motorcade_camera cameraOf(const motorcade_recording* recording) {
  auto camera = sized<motorcade_camera>();
  EXPECT_EQ(motorcade_recording_camera(recording, &camera), MOTORCADE_OK);
  return camera;
}

using CResults = std::vector<Owned<motorcade_result>>;

/// Results as a callback gets them.
struct Taken {
  std::mutex mutex;
  std::condition_variable came;
  CResults results;

  static void take(motorcade_result* result, void* user) {
    auto& taken = *static_cast<Taken*>(user);
    const std::scoped_lock lock(taken.mutex);
    taken.results.emplace_back(result);
    taken.came.notify_all();
  }
  bool waitFor(std::size_t count) {
    std::unique_lock lock(mutex);
    return came.wait_for(lock, std::chrono::minutes(1), [&] { return results.size() == count; });
  }
};

}  // namespace motorcade::test
