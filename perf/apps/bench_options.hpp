#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "apps/pipeline/configuration.hpp"
#include "io/sequence/sequence.hpp"
#include "perf/apps/bench_drive.hpp"

namespace CLI {
class App;
}

namespace motorcade::perf {

/// Options of all measurements of the pipeline.
struct BenchOptions {
  std::filesystem::path sequence, config;
  std::string range;       // A:B
  std::size_t frames = 0;  // length of the drive; 0: the sequence's
  Looping looping = Looping::kForthAndBack;
  std::vector<std::string> assignments;  // key=value
};

void addBenchOptions(CLI::App& command, BenchOptions& options);

/// The configuration in force: defaults, the file, the assignments. Throws UsageError.
PipelineConfig configOf(const BenchOptions& options);
/// The drive to play. Throws UsageError and InputError.
Sequence driveOf(const BenchOptions& options);

}  // namespace motorcade::perf
