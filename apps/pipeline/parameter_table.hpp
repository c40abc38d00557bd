#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <variant>
#include <vector>

namespace motorcade {

struct PipelineConfig;

/// A parameter that takes one of a few names.
struct Choice {
  std::vector<std::string> names;
  std::function<std::size_t()> get;
  std::function<void(std::size_t)> set;
};

/// One key of the configuration file and the member that it sets, with the values that it may take.
struct Parameter {
  std::string section, name;
  std::variant<int*, double*, bool*, Choice> value;
  double least = -std::numeric_limits<double>::infinity(), most = std::numeric_limits<double>::infinity();

  std::string key() const { return section + "." + name; }
  /// What the parameter accepts, for messages and comments: `1 to 16`, `"corners" or "sift"`, ...
  std::string allowed() const;
};

/// Every parameter of a run, bound to the members of `config`: the one place that knows keys and ranges. Sections are contiguous.
std::vector<Parameter> parameterTable(PipelineConfig& config);

}  // namespace motorcade
