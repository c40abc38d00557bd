#pragma once

#include <string>

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

}  // namespace motorcade::test
