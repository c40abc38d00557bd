#pragma once

#include <cstddef>
#include <cstdint>

namespace motorcade {

/// Resources that this process used and others took from it: all that can spoil a measurement of time.
struct ProcessUsage {
  double cpu_s = 0;     // of all threads, user and system
  double stolen_s = 0;  // by the hypervisor, summed over the machine's processors; 0 where the system does not tell
  std::int64_t involuntary_switches = 0;  // a thread had more to do, but its processor went to somebody else
  std::int64_t peak_memory_bytes = 0;     // resident

  /// The difference since `start`; the peak stays the whole process's.
  ProcessUsage since(const ProcessUsage& start) const;
};

/// The usage up to now.
ProcessUsage processUsage();

/// Returns the heap's spare pages to the system. Takes milliseconds, in which other threads may wait for the heap.
void giveBackSpareMemory();
/// Frames between two such calls. The heap's holes grow for hours.
inline constexpr std::size_t kFramesPerTrim = 200;

}  // namespace motorcade
