#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "apps/pipeline/pipeline_config.hpp"

namespace motorcade {

/// Sets the parameters that the TOML text names and leaves the others. Throws UsageError naming file, line and key, and
/// how to fix it. `backend = "filter"` is short for `backend.kind = "filter"`.
void applyToml(PipelineConfig& config, std::string_view toml, const std::string& file_name);
/// The same for a file.
void applyFile(PipelineConfig& config, const std::filesystem::path& file);
/// Sets one parameter from `key=value`; the quotes around a string may be missing.
void applyAssignment(PipelineConfig& config, const std::string& assignment);

/// All parameters in force, each with its purpose and range as a comment; `applyToml` reads it back to the same values.
std::string toToml(const PipelineConfig& config);

}  // namespace motorcade
