#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <mutex>
#include <new>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <pthread.h>

#include "core/image.hpp"
#include "tests/apps/toy_stages.hpp"

/// Counts what a thread asks of the heap and of mutexes while `counting`: through operator new and delete, and, by the linker's --wrap,
/// through the C functions. This test is a program of its own, so that the replacements reach no other.
namespace {

// Volatile: compilers take it that allocating changes no variable of the program.
thread_local volatile bool counting = false;
thread_local volatile int heap_calls = 0, locks = 0;

void countHeapCall() {
  if (counting) heap_calls = heap_calls + 1;
}

}  // namespace

extern "C" {
void* __real_malloc(std::size_t size);
void* __real_calloc(std::size_t number, std::size_t size);
void* __real_realloc(void* block, std::size_t size);
void* __real_aligned_alloc(std::size_t alignment, std::size_t size);
int __real_posix_memalign(void** block, std::size_t alignment, std::size_t size);
void __real_free(void* block);
int __real_pthread_mutex_lock(pthread_mutex_t* mutex);

void* __wrap_malloc(std::size_t size) {
  countHeapCall();
  return __real_malloc(size);
}
void* __wrap_calloc(std::size_t number, std::size_t size) {
  countHeapCall();
  return __real_calloc(number, size);
}
void* __wrap_realloc(void* block, std::size_t size) {
  countHeapCall();
  return __real_realloc(block, size);
}
void* __wrap_aligned_alloc(std::size_t alignment, std::size_t size) {
  countHeapCall();
  return __real_aligned_alloc(alignment, size);
}
int __wrap_posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  countHeapCall();
  return __real_posix_memalign(block, alignment, size);
}
void __wrap_free(void* block) {
  if (block) countHeapCall();
  __real_free(block);
}
int __wrap_pthread_mutex_lock(pthread_mutex_t* mutex) {
  if (counting) locks = locks + 1;
  return __real_pthread_mutex_lock(mutex);
}
}

void* operator new(std::size_t size) {
  if (void* block = std::malloc(size)) return block;
  throw std::bad_alloc();
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  const auto line = static_cast<std::size_t>(alignment);
  if (void* block = std::aligned_alloc(line, (size + line - 1) / line * line)) return block;
  throw std::bad_alloc();
}
void operator delete(void* block) noexcept { std::free(block); }
void operator delete(void* block, std::size_t) noexcept { std::free(block); }
void operator delete(void* block, std::align_val_t) noexcept { std::free(block); }
void operator delete(void* block, std::size_t, std::align_val_t) noexcept { std::free(block); }

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
    const std::scoped_lock lock(mutex);
  });
  EXPECT_EQ(heap_calls, 2);
  EXPECT_EQ(locks, 1);
}

/// While the pipeline hangs in a frame, all pairs but the newest are dropped, and their images let go of, by the camera's thread.
TEST(CameraThread, NeitherLocksNorAsksTheHeapHoweverManyPairsAreDropped) {
  std::atomic<bool> hangs{true}, in_motion{false};
  ToyStages toy{.work = [&](Stage stage, FrameId) {
    if (stage != Stage::kMotion) return;
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
    EXPECT_TRUE(pipeline.push(std::move(frame)));
  };
  shoot();
  while (!in_motion) std::this_thread::yield();
  for (int i = 0; i < 10; ++i) shoot();  // warms the pool
  counted([&] {
    for (int i = 0; i < 1000; ++i) shoot();
    pipeline.passOver({{pairs}, {pairs * kPeriod_ns}});
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
