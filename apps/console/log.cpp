#include "apps/console/log.hpp"

#include <cstdlib>

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

namespace motorcade {

void logDebug(std::string_view message) { spdlog::debug(message); }
void logInfo(std::string_view message) { spdlog::info(message); }
void logWarning(std::string_view message) { spdlog::warn(message); }
void logError(std::string_view message) { spdlog::error(message); }

void startLog() {
  const char* const no_color = std::getenv("NO_COLOR");
  const bool colorless = no_color && *no_color != '\0';
  spdlog::set_default_logger(
      spdlog::stderr_color_mt("motorcade", colorless ? spdlog::color_mode::never : spdlog::color_mode::automatic));
  spdlog::set_pattern("%H:%M:%S.%e %^%l%$ %v");
}

std::vector<std::string> logLevelNames() {
  std::vector<std::string> names;
  for (int level = spdlog::level::trace; level < spdlog::level::n_levels; ++level) {
    const auto& name = spdlog::level::to_string_view(static_cast<spdlog::level::level_enum>(level));
    names.emplace_back(name.data(), name.size());
  }
  return names;
}

void setLogLevel(const std::string& name) { spdlog::set_level(spdlog::level::from_str(name)); }

bool tellsProgress() { return spdlog::should_log(spdlog::level::info); }

}  // namespace motorcade
