#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <memory>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/interface/tracked_drive.hpp"
#include "tests/interface/waiting_thread.hpp"

/// Tests the public interface with the real stages, in as many threads as it allows. Frames are few, small and with
/// little to see, as instrumented code takes its time.
namespace motorcade {
namespace {

constexpr int kWidth_px = 320, kHeight_px = 96;
constexpr double kFocal_px = 180, kBaseline_m = 0.54;

/// Brightness of squares of many grays, the same at each look.
double brightnessAt(double a_m, double b_m) {
  constexpr double kSquare_m = 0.35;
  const auto a = static_cast<std::uint64_t>(std::floor(a_m / kSquare_m) + 1000),
             b = static_cast<std::uint64_t>(std::floor(b_m / kSquare_m) + 1000);
  return static_cast<double>((((a * 2654435761u) ^ (b * 40503u * 97u)) >> 7) % 200);
}

/// Brightness that a camera sees in a corridor: a floor, a ceiling and two walls, each in squares.
double brightnessSeen(double u_px, double v_px, double x_m, double z_m) {
  constexpr double kWall_m = 5, kHigh_m = 1.6;
  const double right = (u_px - kWidth_px / 2.0) / kFocal_px, down = (v_px - kHeight_px / 2.0) / kFocal_px;
  const double to_wall_m = (right > 0 ? kWall_m - x_m : -kWall_m - x_m) / right, to_floor_m = kHigh_m / std::abs(down);
  const double far_m = std::min({to_wall_m, to_floor_m, 60.0});
  return to_wall_m < to_floor_m ? brightnessAt(z_m + far_m, down * far_m)
                                : brightnessAt(z_m + far_m, x_m + right * far_m + (down > 0 ? 0 : 90));
}

std::vector<std::uint8_t> picture(double x_m, double z_m) {
  std::vector<std::uint8_t> pixels;
  for (int v = 0; v < kHeight_px; ++v)
    for (int u = 0; u < kWidth_px; ++u) {
      double sum = 0;
      for (const double du : {-0.3, 0.0, 0.3})
        for (const double dv : {-0.3, 0.0, 0.3}) sum += brightnessSeen(u + du, v + dv + 0.01, x_m, z_m);
      pixels.push_back(static_cast<std::uint8_t>(20 + sum / 9));
    }
  return pixels;
}

/// A drive along the corridor, in which each stage has something to do.
DriveInMemory corridorDrive(std::size_t frames) {
  constexpr double kStep_m = 0.4;
  DriveInMemory drive = blankDrive(frames);
  drive.camera = {.width_px = kWidth_px,
                  .height_px = kHeight_px,
                  .fx_px = kFocal_px,
                  .fy_px = kFocal_px,
                  .cx_px = kWidth_px / 2.0,
                  .cy_px = kHeight_px / 2.0,
                  .baseline_m = kBaseline_m};
  for (std::size_t i = 0; i < frames; ++i) {
    drive.frames[i].left = picture(0, kStep_m * static_cast<double>(i));
    drive.frames[i].right = picture(kBaseline_m, kStep_m * static_cast<double>(i));
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
  const DriveInMemory drive = corridorDrive(12);
  for (const auto policy : {Tracker::Policy::kReplay, Tracker::Policy::kLive}) {
    std::atomic<std::int64_t> called = 0, waited = 0, good = 0;
    Tracker first(drive.camera, optionsOf(policy)), second(drive.camera, optionsOf(policy));
    {
      const auto producer = producerFor(first, drive), other_producer = producerFor(second, drive);
      const auto observer = observerOf(first), other_observer = observerOf(second);
      second.on_result([&](const Result&) { ++called; });
      const std::jthread consumer([&] {
        while (const auto result = first.wait(std::chrono::hours(1))) {
          ++waited;
          good += result->status == Result::Status::kGood && result->cause == Result::Cause::kNone ? 1 : 0;
        }
      });
    }
    EXPECT_EQ(waited, first.counts().results);
    if (policy == Tracker::Policy::kReplay) {
      EXPECT_GE(good, 10);  // the stages had something to do
    }
    EXPECT_EQ(called, second.counts().results);
    EXPECT_EQ(waited + first.counts().dropped, static_cast<std::int64_t>(drive.frames.size()));
  }
}

TEST(TrackerThreads, EndAtAnyMomentWithCallsUnderWay) {
  const DriveInMemory drive = corridorDrive(6);
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

/// Another thread closes while pairs come, as when a program is told to stop.
TEST(TrackerThreads, CloseAmidPushes) {
  const DriveInMemory drive = corridorDrive(8);
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
