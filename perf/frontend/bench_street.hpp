#pragma once

#include <oneapi/tbb/task_arena.h>

#include "core/stereo_camera.hpp"
#include "frontend/messages.hpp"

namespace motorcade::perf {

/// Camera of the benchmarks for images of this width, in KITTI's proportions: 1242 px wide it is KITTI's own.
StereoCamera benchCamera(int width_px);

/// Two successive stereo pairs of a textured plane that comes nearer. Disparities grow from 8 px at the horizon to 68
/// px (at 1242 px width).
struct BenchStreet {
  StereoCamera camera;
  FeaturesPtr before, now;
};

/// Returns the street of this size, which is rendered once. A width of 1242 px takes seconds.
const BenchStreet& benchStreet(int width_px);

/// Calls `work` where its parallel loops find no second thread, so that wall time is CPU time.
template <class Work>
void onOneThread(const Work& work) {
  oneapi::tbb::task_arena(1, 1).execute(work);
}

}  // namespace motorcade::perf
