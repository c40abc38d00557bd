// What stands between a stereo camera and a planner: pairs at camera rate in, objects in the vehicle frame out, and a
// watchdog beside them. README.md says what to copy and what to replace.
#include <atomic>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <thread>

#include <motorcade/motorcade.hpp>
#include <unistd.h>

#include "camera_thread.hpp"
#include "command_line.hpp"
#include "folder_camera.hpp"
#include "health_monitor.hpp"
#include "line_output.hpp"
#include "object_publisher.hpp"
#include "vehicle_frame.hpp"

namespace vehicle_stack {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

enum ExitCode { kDone = 0, kWasBlind = 1, kUsage = 2, kInput = 3 };  // as of `motorcade run` where they mean the same

constexpr auto kWatchEvery = 20ms;
constexpr auto kHealthEvery = 1s;     // where nothing changes
constexpr auto kDrainWithin = 1s;     // for the results of what was pushed
constexpr auto kResultWithin = 50ms;  // then the consumer looks whether it is to end

/// SIGINT and SIGTERM as something to wait for. To be made before all other threads, as they inherit its mask.
class StopSignals {
 public:
  StopSignals() {
    sigemptyset(&signals_);
    sigaddset(&signals_, SIGINT);
    sigaddset(&signals_, SIGTERM);
    pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
    std::signal(SIGPIPE, SIG_IGN);  // a reader that is gone is an error of the write
  }
  bool cameWithin(std::chrono::nanoseconds time) {
    const timespec limit{.tv_sec = 0, .tv_nsec = static_cast<long>(time.count())};
    came_ = came_ || sigtimedwait(&signals_, nullptr, &limit) > 0;
    return came_;
  }

 private:
  sigset_t signals_{};
  bool came_ = false;
};

/// Judges, publishes and says on standard error each change of level, once.
class Watchdog {
 public:
  Watchdog(HealthMonitor& health, ObjectPublisher& publisher, const motorcade::Tracker& tracker)
      : health_(health), publisher_(publisher), tracker_(tracker) {}

  void look(Clock::time_point now) {
    const auto change = health_.check(now);
    if (change)
      std::fprintf(stderr, "vehicle_stack: %s -> %s: %s\n", nameOf(change->from), nameOf(change->to),
                   change->reason.c_str());
    if (!change && now - published_ < kHealthEvery) return;
    published_ = now;
    publisher_.publish(health_, tracker_.counts(), change ? change->reason : "");
  }

 private:
  HealthMonitor& health_;
  ObjectPublisher& publisher_;
  const motorcade::Tracker& tracker_;
  Clock::time_point published_{};
};

/// The one thread that takes results. It ends with the last one, or when it is told to.
std::jthread consume(motorcade::Tracker& tracker, HealthMonitor& health, ObjectPublisher& publisher,
                     std::atomic<bool>& ended) {
  return std::jthread([&](const std::stop_token& stop) {
    while (!stop.stop_requested() && !tracker.done()) {
      const auto result = tracker.wait(kResultWithin);
      if (!result) continue;
      health.received(Clock::now(), *result);
      publisher.publish(*result, health.level());
    }
    ended = true;
  });
}

void tell(motorcade::Tracker::LogLevel level, const std::string& text) {
  if (level != motorcade::Tracker::LogLevel::kInfo) std::fprintf(stderr, "vehicle_stack: tracker: %s\n", text.c_str());
}

void tellCounts(const motorcade::Tracker::Counts& counts, const HealthMonitor& health, std::int64_t left_out) {
  const HealthMonitor::Latency latency = health.latency();
  const std::int64_t abandoned = counts.pushed - counts.rejected - counts.dropped - counts.results;
  std::fprintf(stderr,
               "vehicle_stack: %lld pushed = %lld rejected + %lld dropped + %lld results + %lld abandoned; "
               "%lld untaken, %lld lines left out; latency p50 %.0f p99 %.0f max %.0f ms; ended %s\n",
               static_cast<long long>(counts.pushed), static_cast<long long>(counts.rejected),
               static_cast<long long>(counts.dropped), static_cast<long long>(counts.results),
               static_cast<long long>(abandoned), static_cast<long long>(counts.untaken),
               static_cast<long long>(left_out), latency.p50_ms, latency.p99_ms, latency.max_ms,
               nameOf(health.level()));
}

int drive(const CommandLine& line, StopSignals& signals) {
  FolderCamera camera(line.drive, line.camera, [&] { return signals.cameWithin(0ms); });
  motorcade::Tracker tracker(camera.camera(), line.tracker);
  const HealthMonitor::Limits limits;
  HealthMonitor health(limits, Clock::now());
  LineOutput output(STDOUT_FILENO);
  ObjectPublisher publisher({line.mounting, line.margin}, limits.blind_after,
                            [&](const std::string& text) { output.publish(text); });
  Watchdog watchdog(health, publisher, tracker);
  std::atomic<bool> consumed = false;
  std::jthread consumer = consume(tracker, health, publisher, consumed);
  CameraThread camera_thread([&](const std::stop_token& stop) { return camera.next(stop); }, tracker, health);

  while (!camera_thread.ended() && !output.readerIsGone() && !signals.cameWithin(kWatchEvery))
    watchdog.look(Clock::now());
  camera_thread.stop();
  for (const auto end = Clock::now() + kDrainWithin; !consumed && Clock::now() < end;) {
    watchdog.look(Clock::now());
    std::this_thread::sleep_for(kWatchEvery);
  }
  consumer.request_stop();
  consumer.join();
  tellCounts(tracker.counts(), health, output.leftOut());
  if (!camera_thread.problem().empty())
    std::fprintf(stderr, "vehicle_stack: the camera failed: %s\n", camera_thread.problem().c_str());
  const bool blind = health.level() == Level::kBlind || !camera_thread.problem().empty();
  return blind ? kWasBlind : kDone;
}

}  // namespace
}  // namespace vehicle_stack

int main(int argc, char** argv) try {
  vehicle_stack::StopSignals signals;
  vehicle_stack::CommandLine line = vehicle_stack::parsed(argc, argv);
  line.tracker.policy = motorcade::Tracker::Policy::kLive;
  line.tracker.axes = motorcade::Tracker::Axes::kRep103;
  line.tracker.log = vehicle_stack::tell;
  return vehicle_stack::drive(line, signals);
} catch (const vehicle_stack::UsageError& error) {
  std::fprintf(stderr, "vehicle_stack: %s\n%s", error.what(), vehicle_stack::kUsageText);
  return vehicle_stack::kUsage;
} catch (const motorcade::Error& error) {
  std::fprintf(stderr, "vehicle_stack: %s\n", error.what());
  return vehicle_stack::kInput;
}
