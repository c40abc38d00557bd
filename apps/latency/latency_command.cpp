#include "apps/latency/latency_command.hpp"

#include <cstdio>

#include "apps/latency/latency_table.hpp"
#include "io/errors.hpp"
#include "io/frame_table.hpp"
#include "io/line_file.hpp"

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
