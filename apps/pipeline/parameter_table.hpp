#pragma once

#include <string>
#include <vector>

#include "core/parameters.hpp"

namespace motorcade {

struct PipelineConfig;

/// One key of the configuration file: `key()` is `frontend.optical_flow.max_tracks`.
struct ConfigurationKey {
  std::string section;
  Parameter parameter;

  std::string key() const { return section + "." + parameter.name; }
};

/// Every key, bound to the members of `config`, under its section of the file. Sections are contiguous.
std::vector<ConfigurationKey> parameterTable(PipelineConfig& config);

}  // namespace motorcade
