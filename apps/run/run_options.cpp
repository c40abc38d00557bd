#include <charconv>
#include <cmath>
#include <string_view>

#include "apps/pipeline/configuration.hpp"
#include "apps/run/run_command.hpp"
#include "io/files/errors.hpp"

namespace motorcade {
namespace {

std::optional<double> parseNumber(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace

PipelineConfig configurationOf(const RunOptions& options) {
  PipelineConfig config;
  if (!options.config.empty()) applyFile(config, options.config);
  for (const std::string& assignment : options.assignments) applyAssignment(config, assignment);
  if (!options.min_existence.empty()) applyAssignment(config, "frontend.shapes.min_existence=" + options.min_existence);
  if (options.threads) applyAssignment(config, "pipeline.threads=" + std::to_string(*options.threads));
  if (options.live) config.pipeline.policy = InputPolicy::kLive;
  if (config.backend.window.budget_ms > 0 && config.pipeline.policy != InputPolicy::kLive)
    throw UsageError(
        "backend.budget_ms: a budget in milliseconds would make replay irreproducible; use backend.budget_scalars, or "
        "--live");
  return config;
}

std::optional<double> replayRate_hz(const RunOptions& options, InputPolicy policy) {
  if (options.rate.empty()) return policy == InputPolicy::kLive ? std::optional(options.fps()) : std::nullopt;
  if (options.rate == "max") {
    if (policy == InputPolicy::kLive) throw UsageError("--rate max: a live camera has a rate; give one in Hz");
    return std::nullopt;
  }
  const auto rate_hz = parseNumber(options.rate);
  if (!rate_hz || *rate_hz <= 0)
    throw UsageError("--rate " + options.rate + ": write max or a positive number of pairs per second");
  return rate_hz;
}

std::optional<double> requiredTracking(const RunOptions& options) {
  constexpr std::string_view kKey = "tracked=";
  if (options.require.empty()) return std::nullopt;
  const std::string_view text = options.require;
  const auto fraction = text.starts_with(kKey) ? parseNumber(text.substr(kKey.size())) : std::nullopt;
  if (!fraction || *fraction < 0 || *fraction > 1)
    throw UsageError("--require " + options.require + ": write tracked=FRACTION with a fraction from 0 to 1");
  return fraction;
}

}  // namespace motorcade
