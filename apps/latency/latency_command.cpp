#include "apps/latency/latency_command.hpp"

#include <cstdio>

#include "apps/latency/latency_table.hpp"
#include "io/files/errors.hpp"
#include "io/files/line_file.hpp"
#include "io/results/frame_table.hpp"

namespace motorcade {

int runLatency(const LatencyOptions& options) {
  const auto file = options.run / "frames.csv";
  const auto rows = readFrames(file);
  if (rows.empty()) throw InputError(file.string() + ": no frames; name the folder of a run");
  const LatencyReport report = latencyReport(rows);
  std::fputs(latencyTable(report).c_str(), stdout);
  if (!options.json.empty()) writeAtOnce(options.json, latencyJson(report));
  return 0;
}

}  // namespace motorcade
