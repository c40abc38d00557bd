#include "perf/apps/bench_options.hpp"

#include <CLI/CLI.hpp>

#include "io/files/errors.hpp"
#include "io/layouts/open_sequence.hpp"

namespace motorcade::perf {
namespace {

const std::map<std::string, Looping> kLoopings{{"forth-and-back", Looping::kForthAndBack}, {"round", Looping::kRound}};

}  // namespace

void addBenchOptions(CLI::App& command, BenchOptions& options) {
  command.add_option("SEQUENCE", options.sequence, "Any drive that `motorcade run` reads")->required();
  command.add_option("--range", options.range, "Only the sequence's frames from A up to, not including, B")
      ->type_name("A:B");
  command.add_option("--frames", options.frames, "Length of the drive; the sequence's when absent, looped when longer")
      ->check(CLI::Range(1, 10'000'000));
  command
      .add_option("--loop", options.looping,
                  "How a longer drive goes on: forth-and-back, or round when the sequence ends where it begins")
      ->transform(CLI::CheckedTransformer(kLoopings));
  command.add_option("--config", options.config, "Parameters, as for `motorcade run`")->type_name("FILE.toml");
  command.add_option("--set", options.assignments, "One parameter, as key=value; may come several times")
      ->type_name("KEY=VALUE");
}

PipelineConfig configOf(const BenchOptions& options) {
  PipelineConfig config;
  if (!options.config.empty()) applyFile(config, options.config);
  for (const std::string& assignment : options.assignments) applyAssignment(config, assignment);
  return config;
}

Sequence driveOf(const BenchOptions& options) {
  Sequence sequence = openSequence(options.sequence);
  const FrameRange range =
      (options.range.empty() ? FrameRange{} : parseFrameRange(options.range)).within(sequence.frames.size());
  if (range.size() == 0) throw UsageError("--range " + options.range + ": the sequence has none of these frames");
  const auto cut = [&range](auto& all) {
    all = {all.begin() + static_cast<std::ptrdiff_t>(range.begin),
           all.begin() + static_cast<std::ptrdiff_t>(range.end)};
  };
  cut(sequence.frames);
  cut(sequence.stamps);
  return looped(sequence, options.frames > 0 ? options.frames : range.size(), options.looping);
}

}  // namespace motorcade::perf
