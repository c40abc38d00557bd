#pragma once

#include <memory>
#include <utility>

#include "motorcade/motorcade.h"

namespace motorcade::test {

/// Handles of the C interface that end with their scope.
struct Ender {
  void operator()(motorcade_tracker* tracker) const { motorcade_tracker_destroy(tracker); }
  void operator()(motorcade_recording* recording) const { motorcade_recording_close(recording); }
  void operator()(motorcade_result* result) const { motorcade_result_release(result); }
};
template <class Handle>
using Owned = std::unique_ptr<Handle, Ender>;

/// A struct that knows its size and is zero else.
template <class Struct>
Struct sized() {
  Struct made{};
  made.struct_size = sizeof(Struct);
  return made;
}

/// Options of a program that plays a drive.
inline motorcade_options replayOptions() {
  auto options = sized<motorcade_options>();
  motorcade_options_init(&options);
  options.policy = MOTORCADE_POLICY_REPLAY;
  return options;
}

inline motorcade_camera plainCamera() {
  auto camera = sized<motorcade_camera>();
  camera.width_px = 128;
  camera.height_px = 96;
  camera.fx_px = camera.fy_px = 100;
  camera.cx_px = 64;
  camera.cy_px = 48;
  camera.baseline_m = 0.5;
  return camera;
}

inline Owned<motorcade_tracker> trackerOf(const motorcade_camera& camera, const motorcade_options* options) {
  motorcade_tracker* tracker = nullptr;
  motorcade_tracker_create(&camera, options, &tracker);
  return Owned<motorcade_tracker>(tracker);
}

inline Owned<motorcade_result> taken(motorcade_tracker* tracker) {
  motorcade_result* result = nullptr;
  constexpr int kLong_ms = 60'000;  // a machine that is shared by many
  motorcade_tracker_wait(tracker, kLong_ms, &result);
  return Owned<motorcade_result>(result);
}

}  // namespace motorcade::test
