#pragma once

#include <memory>
#include <set>
#include <stop_token>
#include <string>
#include <vector>

#include "apps/bridge/bridge_command.hpp"
#include "apps/bridge/dds/dds_publisher.hpp"
#include "motorcade/motorcade.hpp"

/// The parts of the bridge that drives and topics share.
namespace motorcade {

/// The tracker's log.
void logToSpdlog(Tracker::LogLevel level, const std::string& text);

/// The public interface's error, without the name of the field: users know files and options.
std::string textOf(const Error& error);

/// Throws UserError; `input` names the source of the camera.
std::unique_ptr<Tracker> makeTracker(const Camera& camera, const Tracker::Options& tracker_options,
                                     const BridgeOptions& options, const std::string& input);

void tellPlace(const DdsPublisher& out, const DdsPlace& place, const std::set<Topic>& topics);
void tellPublished(const std::vector<DdsPublisher::Counts>& topics);

/// Waits for the options' number of subscribers, up to the options' time.
void awaitSubscribers(const DdsPublisher& out, const BridgeOptions& options, const std::stop_token& stop);

}  // namespace motorcade
