#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/interface/tracked_drive.hpp"
#include "tests/interface/waiting_thread.hpp"

/// The public interface with the real stages, in as many threads as it allows: few frames, small and with little to
/// see, as instrumented code takes its time.
namespace motorcade {
namespace {

/// Dots that a camera which drives ahead sees move apart, so that each stage has something to do.
DriveInMemory dottedDrive(std::size_t frames) {
  constexpr int kWidth_px = 128, kHeight_px = 64, kDots = 60;
  DriveInMemory drive = blankDrive(frames);
  drive.camera = {.width_px = kWidth_px,
                  .height_px = kHeight_px,
                  .fx_px = 100,
                  .fy_px = 100,
                  .cx_px = 64,
                  .cy_px = 32,
                  .baseline_m = 0.5};
  for (std::size_t i = 0; i < frames; ++i) {
    auto& [left, right, stamp_ns] = drive.frames[i];
    left.assign(std::size_t{kWidth_px} * kHeight_px, 90);
    right = left;
    for (int dot = 0; dot < kDots; ++dot) {
      const double z_m = 6 + (dot * 7) % 11 - 0.3 * static_cast<double>(i), x_m = (dot * 29) % 17 - 8,
                   y_m = (dot * 13) % 9 * 0.5 - 2;
      const auto draw = [&](std::vector<std::uint8_t>& image, double shift_px) {
        const int u = static_cast<int>(100 * x_m / z_m + 64 - shift_px), v = static_cast<int>(100 * y_m / z_m + 32);
        for (int y = v - 2; y <= v + 2; ++y)
          for (int x = u - 2; x <= u + 2; ++x)
            if (x >= 0 && x < kWidth_px && y >= 0 && y < kHeight_px)
              image[static_cast<std::size_t>(y * kWidth_px + x)] =
                  static_cast<std::uint8_t>(120 + (dot * 37 + (x - u) * (y - v) * 9) % 120);
      };
      draw(left, 0);
      draw(right, 100 * 0.5 / z_m);
    }
  }
  return drive;
}

Tracker::Options optionsOf(Tracker::Policy policy) {
  Tracker::Options options = replay();
  options.policy = policy;
  options.masks = true;
  return options;
}

/// Pushes a drive, from a thread.
std::jthread producerFor(Tracker& tracker, const DriveInMemory& drive) {
  return std::jthread([&] {
    for (std::size_t i = 0; i < drive.frames.size(); ++i) tracker.push(drive.pair(i));
    tracker.close();
  });
}

/// Asks for the counts until a tracker is done, from a thread.
std::jthread observerOf(const Tracker& tracker) {
  return std::jthread([&] {
    while (!tracker.done()) {
      EXPECT_GE(tracker.counts().pushed, 0);
      std::this_thread::yield();
    }
  });
}

TEST(TrackerThreads, TwoAtOnceByWaitAndByCallback) {
  const DriveInMemory drive = dottedDrive(12);
  for (const auto policy : {Tracker::Policy::kReplay, Tracker::Policy::kLive}) {
    std::atomic<std::int64_t> called = 0, waited = 0;
    Tracker first(drive.camera, optionsOf(policy)), second(drive.camera, optionsOf(policy));
    {
      const auto producer = producerFor(first, drive), other_producer = producerFor(second, drive);
      const auto observer = observerOf(first), other_observer = observerOf(second);
      second.on_result([&](const Result&) { ++called; });
      const std::jthread consumer([&] {
        while (first.wait(std::chrono::hours(1))) ++waited;
      });
    }
    EXPECT_EQ(waited, first.counts().results);
    EXPECT_EQ(called, second.counts().results);
    EXPECT_EQ(waited + first.counts().dropped, static_cast<std::int64_t>(drive.frames.size()));
  }
}

TEST(TrackerThreads, EndAtAnyMomentWithCallsUnderWay) {
  const DriveInMemory drive = dottedDrive(6);
  for (std::size_t pairs = 0; pairs < drive.frames.size(); ++pairs) {
    auto tracker = std::make_unique<Tracker>(drive.camera, optionsOf(Tracker::Policy::kReplay));
    if (pairs % 2 == 1) tracker->on_result([](const Result&) {});
    for (std::size_t i = 0; i < pairs; ++i) tracker->push(drive.pair(i));
    tracker.reset();
  }
  auto tracker = std::make_unique<Tracker>(drive.camera, optionsOf(Tracker::Policy::kReplay));
  WaitingThread consumer([t = tracker.get()] { EXPECT_FALSE(t->wait(std::chrono::hours(1))); });
  consumer.awaitSleep();
  tracker.reset();
  consumer.join();
}

/// As a program that is told to stop: another thread closes while pairs come.
TEST(TrackerThreads, CloseAmidPushes) {
  const DriveInMemory drive = dottedDrive(8);
  for (const auto policy : {Tracker::Policy::kReplay, Tracker::Policy::kLive}) {
    Tracker tracker(drive.camera, optionsOf(policy));
    std::atomic<int> pushed = 0;
    std::jthread closer([&] {
      while (pushed < 4) std::this_thread::yield();
      tracker.close();
    });
    std::int64_t accepted = 0;
    for (std::size_t i = 0; i < drive.frames.size(); ++i, ++pushed)
      if (tracker.push(drive.pair(i)).status != Tracker::Push::Status::kRejected) ++accepted;
    closer.join();
    const auto results = static_cast<std::int64_t>(rest(tracker).size());
    EXPECT_EQ(accepted, results + tracker.counts().dropped);
  }
}

}  // namespace
}  // namespace motorcade
