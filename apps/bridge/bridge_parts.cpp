#include "apps/bridge/bridge_parts.hpp"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "apps/bridge/messages/diagnostics.hpp"
#include "apps/console/log.hpp"
#include "io/files/errors.hpp"
#include "io/files/number_text.hpp"
#include "io/files/text_file.hpp"
#include "io/inputs/mounting_text.hpp"
#include "io/messages/camera_info_message.hpp"

namespace motorcade {
namespace {

constexpr std::size_t kMaxConfig_bytes = std::size_t{1} << 20;

bool isFrameId(std::string_view name) {
  const auto plain = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '/' || c == '-';
  };
  return !name.empty() && !name.starts_with('/') && std::ranges::all_of(name, plain);
}

bool isTopic(std::string_view name) {
  const auto plain = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '/'; };
  return name.size() > 1 && name.starts_with('/') && !name.ends_with('/') && std::ranges::all_of(name, plain);
}

}  // namespace

std::optional<double> speedOf(const BridgeOptions& options, double capture_rate_hz) {
  if (options.rate.empty()) return 1;
  if (options.rate == "max") {
    if (options.live) throw UsageError("--rate max: a live camera has a rate; give one in Hz");
    return std::nullopt;
  }
  const auto rate_hz = numberIn(options.rate);
  if (!rate_hz || *rate_hz <= 0)
    throw UsageError("--rate " + options.rate + ": write max or a positive number of pairs per second");
  return capture_rate_hz > 0 ? *rate_hz / capture_rate_hz : 1;
}

FrameIds frameIdsOf(const BridgeOptions& options) {
  if (options.frame_ids.empty()) return {.world = "odom", .child = options.mounting.empty() ? "camera" : "base_link"};
  const auto comma = options.frame_ids.find(',');
  FrameIds ids{.world = options.frame_ids.substr(0, comma),
               .child = comma == std::string::npos ? "" : options.frame_ids.substr(comma + 1)};
  if (!isFrameId(ids.world) || !isFrameId(ids.child) || ids.world == ids.child)
    throw UsageError("--frame-ids " + options.frame_ids +
                     ": write WORLD,CHILD, two different names of letters, digits, _, - and /, which is not the first");
  return ids;
}

SE3 mountingOf(const BridgeOptions& options) {
  return options.mounting.empty() ? SE3() : parseMounting(options.mounting);
}

std::string vehicleMotionTopicOf(const BridgeOptions& options) {
  if (options.vehicle_motion.empty() || isTopic(options.vehicle_motion)) return options.vehicle_motion;
  throw UsageError("--vehicle-motion " + printable(options.vehicle_motion) +
                   ": write a topic, as /vehicle/twist_with_covariance");
}

std::array<CameraTopics, 2> cameraTopicsOf(const BridgeOptions& options) {
  const auto comma = options.images.find(',');
  const std::string left = options.images.substr(0, comma);
  const std::string right = comma == std::string::npos ? "" : options.images.substr(comma + 1);
  if (!isTopic(left) || !isTopic(right) || left == right)
    throw UsageError("--images " + printable(options.images) +
                     ": write LEFT,RIGHT, the topics of the two cameras' images, as "
                     "/left/image_raw,/right/image_raw");
  if (!options.given.empty()) return {CameraTopics{.image = left}, CameraTopics{.image = right}};
  std::array topics{CameraTopics{.image = left, .info = cameraInfoTopicOf(left)},
                    CameraTopics{.image = right, .info = cameraInfoTopicOf(right)}};
  if (topics[0].info == topics[1].info)
    throw UsageError("--images: " + topics[0].info +
                     " would be the camera_info of both; give --camera or --calibration");
  return topics;
}

Tracker::Options trackerOptionsOf(const BridgeOptions& options) {
  Tracker::Options tracker;
  const bool live = options.images.empty() ? options.live : !options.every_pair;
  tracker.policy = live ? Tracker::Policy::kLive : Tracker::Policy::kReplay;
  tracker.axes = Tracker::Axes::kRep103;
  tracker.threads = options.threads;
  if (options.config.empty()) return tracker;
  try {
    tracker.settings = readWhole(options.config, kMaxConfig_bytes);
  } catch (const InputError& error) {
    throw UsageError(error.what());
  }
  return tracker;
}

void logToSpdlog(Tracker::LogLevel level, const std::string& text) {
  switch (level) {
    case Tracker::LogLevel::kInfo:
      return logInfo(text);
    case Tracker::LogLevel::kWarning:
      return logWarning(text);
    case Tracker::LogLevel::kError:
      return logError(text);
  }
}

std::string textOf(const Error& error) { return std::string(error.what()).substr(error.field().size() + 2); }

std::unique_ptr<Tracker> makeTracker(const Camera& camera, const Tracker::Options& tracker_options,
                                     const BridgeOptions& options, const std::string& input) {
  try {
    return std::make_unique<Tracker>(camera, tracker_options);
  } catch (const Error& error) {
    if (error.field().starts_with("camera")) throw InputError(input + ": " + error.what());
    if (error.field() == "options.settings") throw UsageError(options.config.string() + ": " + textOf(error));
    throw UsageError(error.what());
  }
}

void tellPlace(const DdsPublisher& out, const DdsPlace& place, const std::set<Topic>& topics) {
  logInfo(fmt::format("{} in {}", rosNamesOf(topics), textOf(place)));
  if (isLoopback(place) && !out.isShielded())
    logWarning("DDS' sockets cannot be bound to the loopback device: others in the network can send to them");
}

void tellPublished(const std::vector<DdsPublisher::Counts>& topics) {
  for (const auto& topic : topics) {
    logInfo(fmt::format("{}: {} messages published, {} subscribers at the end", topic.topic, topic.published,
                        topic.subscribers));
    if (topic.timed_out > 0)
      logWarning(fmt::format("{}: {} messages were not sent in time", topic.topic, topic.timed_out));
    if (topic.overtaken > 0)
      logWarning(
          fmt::format("{}: {} messages left the history before every subscriber acknowledged them, and may be missing",
                      topic.topic, topic.overtaken));
  }
}

void awaitSubscribers(const DdsPublisher& out, const BridgeOptions& options, const std::stop_token& stop) {
  if (options.subscribers == 0) return;
  const std::chrono::milliseconds patience(std::llround(1e3 * options.patience_s));
  if (!out.waitForSubscribers(options.subscribers, patience, stop) && !stop.stop_requested())
    logWarning(fmt::format("not every topic has {} subscribers after {} s (--wait-at-most): going on without",
                           options.subscribers, options.patience_s));
}

ResultPublisher::ResultPublisher(DdsPublisher& out, const Params& params)
    : out_(out), params_(params), markers_({.frame_id = params.ids.world, .lifetime_s = params.marker_lifetime_s}) {}

void ResultPublisher::publish(const Result& result) {
  const auto& [world, child] = params_.ids;
  const Result seen = seenFromVehicle(result, params_.T_child_cam);
  const std::int64_t first_stamp_ns = first_stamp_ns_.value_or(seen.stamp_ns);
  const auto wanted = [this](Topic topic) { return out_.publishes(topic); };
  if (wanted(Topic::kPose)) out_.publish(poseStampedOf(seen, params_.ids));
  if (wanted(Topic::kOdometry)) out_.publish(odometryOf(seen, params_.ids));
  if (wanted(Topic::kMarkers)) out_.publish(markers_(seen));
  if (wanted(Topic::kTrackedObjects)) out_.publish(trackedObjectsOf(seen, world, first_stamp_ns));
  if (wanted(Topic::kDetections)) out_.publish(detectionsOf(seen, child, first_stamp_ns));
  if (wanted(Topic::kDiagnostics)) out_.publish(diagnosticsOf(seen, params_.drive));
  if (wanted(Topic::kTf)) out_.publish(transformStampedOf(seen, params_.ids));
  first_stamp_ns_ = first_stamp_ns;
}

}  // namespace motorcade
