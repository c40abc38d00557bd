#include "apps/bridge/bridge_parts.hpp"

#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "apps/console/log.hpp"
#include "io/files/errors.hpp"

namespace motorcade {

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

}  // namespace motorcade
