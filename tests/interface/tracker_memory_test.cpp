#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <pthread.h>

#include "tests/interface/tracked_drive.hpp"
#include "tests/support/replaced_heap.hpp"

/// Counts the calls of the heap and of mutexes by `push`, and refuses it memory. A program of its own, so that the
/// replacements reach no other test.
namespace {

// Volatile: compilers take it that allocating changes no variable of the program.
thread_local volatile bool counting = false, refusing = false;
thread_local volatile int heap_calls = 0, locks = 0;

void countHeapCall() {
  if (counting) heap_calls = heap_calls + 1;
}

}  // namespace

bool heapTaken() {
  countHeapCall();
  return !refusing;
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

/// One picture for both sides, in a format of which it has enough bytes, and for the labels where there are some.
class Camera30Hz {
 public:
  explicit Camera30Hz(const DriveInMemory& drive, Pair::Format format, bool labelled = false)
      : drive_(drive), format_(format), labelled_(labelled), pixels_(3 * drive.frames[0].left.size(), 90) {}

  Pair next() {
    constexpr std::int64_t kPeriod_ns = 33'000'000;
    Pair pair = drive_.pair(0);
    pair.left.pixels = pair.right.pixels = pixels_.data();
    pair.left.format = pair.right.format = format_;
    if (labelled_) pair.instances = pair.left;
    pair.stamp_ns = kPeriod_ns * pairs_++;
    return pair;
  }

 private:
  const DriveInMemory& drive_;
  Pair::Format format_;
  bool labelled_;
  std::vector<std::uint8_t> pixels_;
  std::int64_t pairs_ = 0;
};

/// Expects no call from the first pair on.
void expectNothingAsked(Tracker& tracker, Camera30Hz& camera) {
  heap_calls = 0;
  locks = 0;
  int taken = 0;
  for (int pushes = 0; pushes < 400; ++pushes) {
    const Pair pair = camera.next();
    counting = true;
    const auto outcome = tracker.push(pair);
    counting = false;
    taken += outcome.status == Tracker::Push::Status::kRejected ? 0 : 1;
    if (pushes % 20 == 0) {
      tracker.poll();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  EXPECT_EQ(taken, 400);
  EXPECT_EQ(heap_calls, 0);
  EXPECT_EQ(locks, 0);
}

void expectNothingAsked(const DriveInMemory& drive, Pair::Format format) {
  Tracker tracker(drive.camera, {});
  Camera30Hz camera(drive, format);
  expectNothingAsked(tracker, camera);
}

Camera rigOf(const Camera& camera) {
  Camera::Lens lens{.fx_px = camera.fx_px,
                    .fy_px = camera.fy_px,
                    .cx_px = camera.cx_px,
                    .cy_px = camera.cy_px,
                    .distortion = Camera::Distortion::kRadialTangential,
                    .coefficients = {-0.05, 0.01}};
  return {.width_px = camera.width_px,
          .height_px = camera.height_px,
          .rig = Camera::Rig{.left = lens, .right = lens, .T_right_left = {1, 0, 0, -0.5, 0, 1, 0, 0, 0, 0, 1, 0}}};
}

TEST(TrackerMemory, TheCounterSeesTheHeap) {
  heap_calls = 0;
  counting = true;
  {
    const std::vector<double> vector(100, 1.0);
    seeBlock(vector.data());
  }
  counting = false;
  EXPECT_EQ(heap_calls, 2);
}

TEST(TrackerMemory, APushInLiveAsksNothingOfTheHeapAndTakesNoLock) {
  const DriveInMemory drive = blankDrive(1);
  for (const auto format : {Pair::Format::kGray8, Pair::Format::kGray16, Pair::Format::kRgb8, Pair::Format::kBgr8})
    expectNothingAsked(drive, format);
}

TEST(TrackerMemory, NeitherDoesOneThatRectifies) {
  DriveInMemory drive = blankDrive(1);
  drive.camera = rigOf(drive.camera);
  for (const auto format : {Pair::Format::kGray8, Pair::Format::kRgb8}) expectNothingAsked(drive, format);
}

TEST(TrackerMemory, NorDoesOneWithInstanceLabelsAfterTheFirst) {
  const DriveInMemory drive = blankDrive(1);
  for (const auto format : {Pair::Format::kGray8, Pair::Format::kGray16}) {
    Tracker tracker(drive.camera, {});
    Camera30Hz camera(drive, format, true);
    EXPECT_NE(tracker.push(camera.next()).status, Tracker::Push::Status::kRejected);
    expectNothingAsked(tracker, camera);
  }
}

/// The pair is rejected, and the next one is as any other. In live its memory is there from the beginning.
TEST(TrackerMemory, APushForWhichThereIsNoMemoryIsRejected) {
  constexpr int kRefused = 300;  // more than there is room for results: none is lost by it
  const DriveInMemory drive = blankDrive(1);
  Tracker::Options options = replay();
  options.patience = std::chrono::milliseconds(1);
  Tracker tracker(drive.camera, options);
  for (int tries = 0; tries < kRefused; ++tries) {
    refusing = true;
    const auto outcome = tracker.push(drive.pair(0));
    refusing = false;
    ASSERT_EQ(outcome.status, Tracker::Push::Status::kRejected);
    ASSERT_STREQ(outcome.why, "out of memory");
  }
  EXPECT_EQ(tracker.push(drive.pair(0)).status, Tracker::Push::Status::kAccepted);
  tracker.close();
  EXPECT_EQ(rest(tracker).size(), 1u);
  EXPECT_EQ(tracker.counts().rejected, kRefused);
}

}  // namespace
}  // namespace motorcade
