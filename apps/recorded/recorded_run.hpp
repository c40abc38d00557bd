#pragma once

#include <filesystem>
#include <optional>

#include "io/results/run_folder.hpp"
#include "io/sequence/sequence.hpp"

/// What a run folder tells about its own run.
namespace motorcade {

/// Whether a run came to its end there; a folder that a killed or interrupted run left does not count.
bool holdsFinishedRun(const std::filesystem::path& folder);

/// Tells whether pairs came at the pace of a clock (`--rate`, `--live`); latency then counts from when a pair was due.
/// Without a clock, pairs follow each other as fast as they can, and latency is mostly waiting. Returns false if the
/// run does not record its pace.
bool wasPaced(const RunFolder& run);

/// Which sequence the user says that a run is of; what is empty stands in the run's summary.
struct NamedSequence {
  std::filesystem::path folder{};
  std::optional<double> fps_hz{};  // where the sequence has no times
};

/// The sequence that a run is of. Throws InputError where neither the user nor the summary names it, where it cannot be
/// used, and where it is another one than was run.
Sequence openSequenceOf(const RunFolder& run, const NamedSequence& named);

/// Throws InputError, naming both, where a run has frames that the sequence has not, or most of its frames were taken
/// at other times; times that faults changed on purpose, and those of runs that did not end in order, prove nothing.
void requireSameDrive(const RunFolder& run, const Sequence& sequence);

}  // namespace motorcade
