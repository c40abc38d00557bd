#include "apps/pipeline/configuration.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace motorcade;

/// Table of parameters in place of the real one: numbers, switches and choices of the parts that need no stage. Only
/// the number of keys differs.
std::vector<ConfigurationKey> motorcade::parameterTable(PipelineConfig& config) {
  std::vector<ConfigurationKey> table;
  const auto add = [&](const std::string& section, const std::vector<Parameter>& parameters) {
    for (const Parameter& parameter : parameters) table.push_back({section, parameter});
  };
  add("pipeline", parametersOf(config.pipeline));
  add("backend", parametersOf(config.backend.window));
  add("backend", parametersOf(config.backend.pose_graph));
  add("backend.joint", parametersOf(config.backend.joint));
  return table;
}

/// A configuration file; what it sets is legal, and is read back as it was written.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::MemoryFile file;
  const auto& path = file.holding(fuzz::textOf(data, size));
  fuzz::readOrRefuse(path.native(), {}, [&] {
    PipelineConfig config, again;
    applyFile(config, path);
    const std::string written = toToml(config);
    applyToml(again, written, "written");
    fuzz::require(toToml(again) == written, "a configuration that changes when it is written and read");
    requireValid(config.pipeline);
    requireValid(config.backend.window);
    requireValid(config.backend.pose_graph);
    requireValid(config.backend.joint);
  });
  return 0;
}
