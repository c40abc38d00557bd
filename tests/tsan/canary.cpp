#include <atomic>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "apps/pipeline/pipeline.hpp"

/// Data races planted on purpose, of the kinds that the tests under ThreadSanitizer look for.
namespace motorcade {
namespace {

/// Race of two threads that count in one plain variable.
long raceOfThreads() {
  long counter = 0;
  const auto count = [&counter] {
    for (int i = 0; i < 1000; ++i) ++counter;
  };
  { const std::jthread a(count), b(count); }
  return counter;
}

/// Race of a ring of one slot whose index is published without release.
long raceOfRing() {
  std::vector<long> slot(1);
  std::atomic<long> pushed{0}, popped{0};
  std::jthread producer([&] {
    for (long value = 1; value <= 1000; ++value) {
      while (popped.load(std::memory_order_relaxed) != value - 1) std::this_thread::yield();
      slot[0] = value;
      pushed.store(value, std::memory_order_relaxed);
    }
  });
  long sum = 0;
  for (long value = 1; value <= 1000; ++value) {
    while (pushed.load(std::memory_order_relaxed) != value) std::this_thread::yield();
    sum += slot[0];
    popped.store(value, std::memory_order_relaxed);
  }
  return sum;
}

/// Race of a stage that has a memory and is run on several frames at once.
long raceOfStage() {
  long counter = 0;
  Stages stages;
  stages.prepare = [&counter](const StereoFramePtr& frame) {
    ++counter;
    std::this_thread::sleep_for(std::chrono::microseconds(300));
    ++counter;
    Features features;
    features.frame = frame;
    return std::make_shared<const Features>(std::move(features));
  };
  stages.stereo_matching = [](const FeaturesPtr& features) {
    return std::make_shared<const StereoMatches>(StereoMatches{features, {}});
  };
  stages.optical_flow = [](const FeaturesPtr& features) {
    return std::make_shared<const OpticalFlow>(OpticalFlow{features, {}});
  };
  stages.scene_flow_segmentation = [](const StereoMatchesPtr&, const OpticalFlowPtr&) {
    return std::make_shared<const SceneMotion>();
  };
  stages.tracking = [](const SceneMotionPtr&) { return std::make_shared<const FrameMeasurements>(); };
  stages.incremental_optimization = [](const FrameMeasurementsPtr&) { return std::make_shared<const Estimates>(); };
  stages.object_shapes = [](const ObjectShapes::Inputs&, const EstimatesPtr& e) { return e; };
  stages.finish = [] { return std::vector<FrameEstimate>(); };
  Pipeline pipeline({.threads = 2}, std::move(stages));
  std::jthread producer([&pipeline] {
    for (std::int64_t i = 0; i < 200; ++i) {
      StereoFrame frame;
      frame.head.stamp = {100'000'000 * i};
      pipeline.push(std::move(frame));
    }
    pipeline.close();
  });
  while (pipeline.next()) {
  }
  pipeline.finish();
  return counter;
}

}  // namespace
}  // namespace motorcade

int main(int argc, char** argv) {
  const std::string_view race = argc == 2 ? argv[1] : "";
  if (race == "threads") return std::printf("%ld\n", motorcade::raceOfThreads()), 0;
  if (race == "ring") return std::printf("%ld\n", motorcade::raceOfRing()), 0;
  if (race == "stage") return std::printf("%ld\n", motorcade::raceOfStage()), 0;
  std::fprintf(stderr, "tsan_canary threads|ring|stage\n");
  return 2;
}
