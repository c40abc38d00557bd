#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

#include "io/results/run_folder.hpp"
#include "io/sequence/sequence.hpp"

/// Facts about a run that its folder records.
namespace motorcade {

/// True when a run in the folder came to its end. A folder that a killed or interrupted run left does not count.
bool holdsFinishedRun(const std::filesystem::path& folder);

/// True if pairs came at the pace of a clock (`--rate`, `--live`); latency then counts from when a pair was due.
/// Pairs follow each other as fast as they can without a clock, and latency is mostly waiting. False if the run does
/// not record its pace.
bool wasPaced(const RunFolder& run);

/// The sequence of a run as the user names it. Empty fields are taken from the run's summary.
struct NamedSequence {
  std::filesystem::path folder{};
  std::optional<double> fps_hz{};  // where the sequence has no times
};

/// Opens the sequence of a run. Throws InputError where neither the user nor the summary names it, where it cannot be
/// used, and where the run was made of another one.
Sequence openSequenceOf(const RunFolder& run, const NamedSequence& named);

/// Throws InputError, naming both, where a run has frames that the sequence lacks, or most of its frames were taken at
/// other times. Times do not count if faults changed them on purpose, or if the run did not end in order.
void requireSameDrive(const RunFolder& run, const Sequence& sequence);

/// Completes the final estimates of a run that did not end in order. Frames without one get the online estimate, moved
/// to the camera's last final pose. Returns their number.
std::size_t recoverFinals(RunFolder& run);

}  // namespace motorcade
