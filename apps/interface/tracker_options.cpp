#include "apps/interface/tracker_options.hpp"

#include <string>
#include <thread>
#include <vector>

#include "apps/interface/camera_model.hpp"
#include "io/files/errors.hpp"

namespace motorcade {
namespace {

constexpr int kMostCovarianceFrames = 60;  // every back-end remembers as many

/// Tries a thread placement on a thread of its own.
std::string problemWith(const ThreadPlacement& placement) {
  std::string problem;
  std::jthread([&] { problem = PlacedThread(placement).problem(); }).join();
  return problem;
}

/// Requires each processor by itself: of several, the system silently leaves out missing ones.
void requireProcessors(const std::vector<int>& cpus) {
  for (const int cpu : cpus) {
    const std::string has = "has " + std::to_string(cpu) + "; ";
    if (cpu < 0) throw Error("options.cpus", has + "processors count from 0");
    if (const auto problem = problemWith({.cpus = {cpu}}); !problem.empty()) throw Error("options.cpus", has + problem);
  }
}

void requirePlacement(const ThreadPlacement& placement) {
  requireProcessors(placement.cpus);
  if (placement.realtime_priority < 0 || placement.realtime_priority > 99)
    throw Error("options.realtime_priority", "is " + std::to_string(placement.realtime_priority) + "; it is 0 to 99");
  if (const auto problem = problemWith({.realtime_priority = placement.realtime_priority}); !problem.empty())
    throw Error("options.realtime_priority", problem);
}

InputPolicy policyOf(Tracker::Policy policy) {
  if (policy == Tracker::Policy::kLive) return InputPolicy::kLive;
  if (policy == Tracker::Policy::kReplay) return InputPolicy::kReplay;
  throw Error("options.policy", "is none of those that there are");
}

void requireValid(const Tracker::Options& options) {
  if (options.axes != Tracker::Axes::kOptical && options.axes != Tracker::Axes::kRep103)
    throw Error("options.axes", "are none of those that there are");
  if (options.threads < 1 || options.threads > 64)
    throw Error("options.threads", "is " + std::to_string(options.threads) + "; it is 1 to 64");
  if (options.covariance_frames < 1 || options.covariance_frames > kMostCovarianceFrames)
    throw Error("options.covariance_frames", "is " + std::to_string(options.covariance_frames) + "; it is 1 to " +
                                                 std::to_string(kMostCovarianceFrames));
  if (options.patience.count() < 0) throw Error("options.patience", "is negative");
}

/// Throws where the settings contradict an option. A value that has an option of its own may stand in them, as in the
/// file that a run writes.
void requireAgreement(const PipelineParams& settings, const Tracker::Options& options) {
  if (settings.threads != options.threads)
    throw Error("options.settings", "say pipeline.threads = " + std::to_string(settings.threads) +
                                        ", options.threads is " + std::to_string(options.threads) +
                                        "; leave the one out, or set the other");
  if (settings.policy != policyOf(options.policy))
    throw Error("options.settings", "say another pipeline.policy than options.policy; leave it out, or set the other");
}

/// Throws where results of a replay would depend on the machine, as `run` does.
void requireReproducible(const PipelineConfig& config) {
  if (config.backend.window.budget_ms > 0 && config.pipeline.policy != InputPolicy::kLive)
    throw Error("options.settings",
                "say backend.budget_ms: a budget in milliseconds would make replay irreproducible; use "
                "backend.budget_scalars, or the live policy");
}

}  // namespace

PipelineConfig configOf(const Tracker::Options& options, const Camera& camera) {
  requireValid(options);
  PipelineConfig config;
  config.pipeline.threads = options.threads;
  config.pipeline.policy = policyOf(options.policy);
  config.backend.window.motion_frames = options.covariance_frames;
  config.pipeline.placement = {.cpus = options.cpus, .realtime_priority = options.realtime_priority};
  try {
    applyToml(config, options.settings, "the settings");
  } catch (const UsageError& error) {
    throw Error("options.settings", error.what());
  }
  const auto sigmas = sigmasOf(camera);
  if (CalibrationSigmas& set = config.backend.window.calibration; sigmas && set == CalibrationSigmas{}) set = *sigmas;
  requireAgreement(config.pipeline, options);
  requireReproducible(config);
  requirePlacement(config.pipeline.placement);
  return config;
}

LogCallback logOf(const Tracker::Options& options) {
  if (!options.log) return [](LogLevel, const std::string&) {};
  return [log = options.log](LogLevel level, const std::string& text) {
    Tracker::LogLevel told = Tracker::LogLevel::kError;
    if (level == LogLevel::kInfo) told = Tracker::LogLevel::kInfo;
    if (level == LogLevel::kWarning) told = Tracker::LogLevel::kWarning;
    try {
      log(told, text);
    } catch (...) {  // no frame may be lost for a line
    }
  };
}

}  // namespace motorcade
