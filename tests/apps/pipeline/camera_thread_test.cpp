#include <atomic>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <pthread.h>

#include "core/image.hpp"
#include "tests/apps/pipeline/toy_stages.hpp"
#include "tests/support/replaced_heap.hpp"

/// Counts a thread's calls of the heap and of mutexes while `counting`. This test is a program of its own, so that the
/// replacements reach no other.
namespace {

// Volatile: compilers take it that allocating changes no variable of the program.
thread_local volatile bool counting = false;
thread_local volatile int heap_calls = 0, locks = 0;

void countHeapCall() {
  if (counting) heap_calls = heap_calls + 1;
}

}  // namespace

bool heapTaken() {
  countHeapCall();
  return true;
}
void heapGiven() { countHeapCall(); }

// NOLINTBEGIN(*-reserved-identifier, readability-identifier-naming): the linker names them
extern "C" {
int __real_pthread_mutex_lock(pthread_mutex_t* mutex);
int __wrap_pthread_mutex_lock(pthread_mutex_t* mutex) {
  if (counting) locks = locks + 1;
  return __real_pthread_mutex_lock(mutex);
}
}
// NOLINTEND(*-reserved-identifier, readability-identifier-naming)

namespace motorcade {
namespace {

/// Calls `work` on this thread, and counts.
template <class Work>
void counted(const Work& work) {
  heap_calls = 0;
  locks = 0;
  counting = true;
  work();
  counting = false;
}

TEST(CameraThread, TheCountersSeeTheHeapAndMutexes) {
  std::mutex mutex;
  counted([&] {
    const std::vector<double> vector(100, 1.0);
    seeBlock(vector.data());
    const std::scoped_lock lock(mutex);
  });
  EXPECT_EQ(heap_calls, 2);
  EXPECT_EQ(locks, 1);
}

/// Drops all pairs but the newest, and releases their images, on the camera's thread, while the pipeline hangs in a
/// frame.
TEST(CameraThread, NeitherLocksNorAsksTheHeapHoweverManyPairsAreDropped) {
  std::atomic<bool> hangs{true}, in_motion{false};
  ToyStages toy{.work = [&](Stage stage, FrameId) {
    if (stage != Stage::kSceneFlowSegmentation) return;
    in_motion = true;
    hangs.wait(true);
  }};
  Pipeline pipeline({.threads = 2, .frames_in_flight = 2, .policy = InputPolicy::kLive}, toy.stages());
  ImagePool pool;
  std::int64_t pairs = 0;
  const auto shoot = [&] {
    StereoFrame frame = frameAt(pairs++);
    frame.left = pool.acquire(64, 32);
    frame.right = pool.acquire(64, 32);
    EXPECT_TRUE(isTaken(pipeline.push(std::move(frame))));
  };
  shoot();
  while (!in_motion) std::this_thread::yield();
  for (int i = 0; i < 10; ++i) shoot();  // warms the pool
  counted([&] {
    for (int i = 0; i < 1000; ++i) shoot();
    pipeline.passOver({pairs}, {pairs * kPeriod_ns});
  });
  ++pairs;
  EXPECT_EQ(heap_calls, 0);
  EXPECT_EQ(locks, 0);

  hangs = false;
  hangs.notify_all();
  const PipelineEnd end = pipeline.finish();
  EXPECT_EQ(end.summary.received, pairs);
  EXPECT_GE(end.summary.dropped, 1000);
}

}  // namespace
}  // namespace motorcade
