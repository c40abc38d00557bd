#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <autoware_perception_msgs.h>
#include <dds/dds.h>
#include <sys/wait.h>
#include <unistd.h>

#include "apps/bridge/dds/dds_configuration.hpp"
#include "core/latency_histogram.hpp"
#include "io/files/errors.hpp"
#include "io/layouts/open_sequence.hpp"
#include "motorcade/motorcade.hpp"
#include "perf/apps/bench_drive.hpp"
#include "tests/apps/bridge/bridged_cameras.hpp"

/// Measures the time from a pair's image topics to its published objects, in `motorcade bridge`, beside the time from
/// `Tracker::push` to the result, for the same pairs at the same rate.
namespace motorcade::perf {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::nanoseconds;

struct TopicLatencyOptions {
  std::filesystem::path drive, program = "build/release/apps/motorcade";
  double rate_hz = 30, seconds = 30;
  int domain = 99, threads = 2;
};

double since_ms(Clock::time_point then) {
  return std::chrono::duration<double, std::milli>(Clock::now() - then).count();
}

/// A drive's pairs in memory. They are played forth and back, at a rate of their own.
class HeldPairs {
 public:
  explicit HeldPairs(const std::string& folder) : recording_(folder), camera_(recording_.camera()) {
    for (std::int64_t i = 0; i < recording_.size(); ++i) {
      const Pair pair = recording_.read(i);
      if (pair.left.pixels == nullptr || pair.right.pixels == nullptr)
        throw InputError(folder + ": image " + std::to_string(i) + " cannot be read; measure on a whole drive");
      images_.emplace_back(copyOf(pair.left), copyOf(pair.right));
    }
    if (images_.size() < 2) throw InputError(folder + ": has fewer than two pairs");
  }
  const Camera& camera() const { return camera_; }
  Pair pair(std::size_t index, std::int64_t stamp_ns) const {
    const std::size_t last = images_.size() - 1, place = index % (2 * last);
    const auto& [left, right] = images_[std::min(place, 2 * last - place)];
    return {.left = imageOf(left), .right = imageOf(right), .stamp_ns = stamp_ns};
  }

 private:
  using Pixels = std::vector<std::uint8_t>;
  static Pixels copyOf(const Pair::Image& image) {
    const auto* row = static_cast<const std::uint8_t*>(image.pixels);
    Pixels pixels;
    for (int y = 0; y < image.height_px; ++y, row += image.stride_bytes)
      pixels.insert(pixels.end(), row, row + image.width_px);
    return pixels;
  }
  Pair::Image imageOf(const Pixels& pixels) const {
    return {.pixels = pixels.data(),
            .width_px = camera_.width_px,
            .height_px = camera_.height_px,
            .stride_bytes = camera_.width_px};
  }

  Recording recording_;
  Camera camera_;
  std::vector<std::pair<Pixels, Pixels>> images_;
};

/// Calls `take` with each pair of the drive, when it is due.
template <class Take>
void play(const HeldPairs& pairs, const TopicLatencyOptions& options, const Take& take) {
  const nanoseconds period(static_cast<std::int64_t>(1e9 / options.rate_hz));
  const auto count = static_cast<std::size_t>(options.seconds * options.rate_hz);
  auto due = Clock::now();
  for (std::size_t i = 0; i < count; ++i, due += period) {
    std::this_thread::sleep_until(due);
    take(pairs.pair(i, 1'000'000'000'000 + static_cast<std::int64_t>(i) * period.count()));
  }
}

LatencyHistogram fromPush(const HeldPairs& pairs, const TopicLatencyOptions& options) {
  Tracker tracker(pairs.camera(), {.policy = Tracker::Policy::kLive, .threads = options.threads});
  LatencyHistogram latency;
  tracker.on_result([&](const Result& result) { latency.add(result.latency_ms); });
  play(pairs, options, [&](const Pair& pair) { tracker.push(pair); });
  tracker.close();
  while (!tracker.done()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return latency;
}

/// Times at which pairs were published, until their objects come.
class Arrivals {
 public:
  void sent(std::int64_t stamp_ns) {
    const std::scoped_lock lock(mutex_);
    sent_.emplace(stamp_ns, Clock::now());
  }
  void came(std::int64_t stamp_ns) {
    const std::scoped_lock lock(mutex_);
    const auto pair = sent_.find(stamp_ns);
    if (pair == sent_.end()) return;
    latency_.add(since_ms(pair->second));
    sent_.erase(pair);
  }
  LatencyHistogram latency() const {
    const std::scoped_lock lock(mutex_);
    return latency_;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::int64_t, Clock::time_point> sent_;
  LatencyHistogram latency_;
};

/// Tells the arrivals of each message of objects, on a thread of DDS.
void takeObjects(dds_entity_t reader, void* arrivals) {
  constexpr int kMost = 16;
  void* samples[kMost] = {};
  dds_sample_info_t infos[kMost];
  const int taken = dds_take(reader, samples, infos, kMost, kMost);
  for (int i = 0; i < taken; ++i) {
    if (!infos[i].valid_data) continue;
    const auto& stamp = static_cast<const autoware_perception_msgs_msg_dds__TrackedObjects_*>(samples[i])->header.stamp;
    static_cast<Arrivals*>(arrivals)->came(stamp.sec * std::int64_t{1'000'000'000} + stamp.nanosec);
  }
  if (taken > 0) dds_return_loan(reader, samples, taken);
}

/// A subscriber to the objects, in the domain of the publishers.
void subscribe(int domain, Arrivals& arrivals) {
  const dds_entity_t participant = dds_create_participant(static_cast<dds_domainid_t>(domain), nullptr, nullptr);
  dds_listener_t* const listener = dds_create_listener(&arrivals);
  dds_lset_data_available(listener, takeObjects);
  const dds_entity_t topic = dds_create_topic(participant, &autoware_perception_msgs_msg_dds__TrackedObjects__desc,
                                              "rt/motorcade/tracked_objects", nullptr, nullptr);
  dds_qos_t* const qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  const dds_entity_t reader = dds_create_reader(participant, topic, qos, listener);
  dds_delete_qos(qos);
  dds_delete_listener(listener);
  if (reader < 0) throw std::runtime_error(dds_strretcode(reader));
}

/// `motorcade bridge` over the cameras' topics, in a process of its own. It ends with the object.
class BridgeProcess {
 public:
  explicit BridgeProcess(const TopicLatencyOptions& options) : id_(::fork()) {
    if (id_ != 0) return;
    const std::string program = options.program, domain = std::to_string(options.domain),
                      threads = std::to_string(options.threads);
    ::execl(program.c_str(), program.c_str(), "bridge", "--images", "/left/image_raw,/right/image_raw", "--domain",
            domain.c_str(), "--threads", threads.c_str(), "--wait-for-subscribers", "0", "--quiet", nullptr);
    ::_exit(127);
  }
  ~BridgeProcess() {
    ::kill(id_, SIGTERM);
    ::waitpid(id_, nullptr, 0);
  }
  BridgeProcess(const BridgeProcess&) = delete;
  BridgeProcess& operator=(const BridgeProcess&) = delete;

 private:
  pid_t id_;
};

LatencyHistogram fromTopic(const HeldPairs& pairs, const TopicLatencyOptions& options) {
  using test::CameraPublishers;
  const BridgeProcess bridge(options);
  Arrivals arrivals;
  const CameraPublishers cameras(options.domain, test::Driver::kBestEffort);
  subscribe(options.domain, arrivals);
  if (!cameras.areSubscribed(std::chrono::seconds(30)))
    throw std::runtime_error(options.program.string() + " bridge: has not subscribed within 30 s");
  play(pairs, options, [&](const Pair& pair) {
    arrivals.sent(pair.stamp_ns);
    cameras.publishInfos(pairs.camera(), pair.stamp_ns);
    cameras.publish(StereoSide::kLeft, pair.left, pair.stamp_ns);
    cameras.publish(StereoSide::kRight, pair.right, pair.stamp_ns);
  });
  std::this_thread::sleep_for(std::chrono::seconds(1));  // for the last ones
  return arrivals.latency();
}

void printLine(const char* what, const LatencyHistogram& latency) {
  std::printf("%-28s %8lld %8.1f %8.1f %8.1f\n", what, static_cast<long long>(latency.count()),
              latency.percentile_ms(0.5), latency.percentile_ms(0.99), latency.max_ms());
}

int measure(const TopicLatencyOptions& options) {
  const HeldPairs pairs(options.drive);
  const LatencyHistogram push = fromPush(pairs, options), topic = fromTopic(pairs, options);
  std::printf("%-28s %8s %8s %8s %8s\n", "ms", "results", "p50", "p99", "max");
  printLine("push to result", push);
  printLine("topic to published objects", topic);
  const double more_ms = topic.percentile_ms(0.99) - push.percentile_ms(0.99);
  std::printf("p99 is %.1f ms more", more_ms);
  if (const auto unit = unit_ms(openSequence(options.drive)))
    std::printf(", %.2f units of %.1f ms", more_ms / *unit, *unit);
  std::printf("\n");
  return topic.count() > 0 ? 0 : 1;
}

}  // namespace
}  // namespace motorcade::perf

int main(int argc, char** argv) {
  try {
    motorcade::perf::TopicLatencyOptions options;
    CLI::App app("Measures the time from image topics to published objects, beside that from push to result.",
                 "topic_latency_bench");
    app.add_option("drive", options.drive, "Folder of a sequence")->required();
    app.add_option("--program", options.program, "The program motorcade")->capture_default_str();
    app.add_option("--rate", options.rate_hz, "Pairs per second")->capture_default_str();
    app.add_option("--seconds", options.seconds, "Length of each of the two measurements")->capture_default_str();
    app.add_option("--threads", options.threads, "Workers of each tracker")->capture_default_str();
    app.add_option("--domain", options.domain, "A DDS domain that nobody else uses")->capture_default_str();
    CLI11_PARSE(app, argc, argv);
    return motorcade::perf::measure(options);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "topic_latency_bench: %s\n", error.what());
    return 1;
  }
}
