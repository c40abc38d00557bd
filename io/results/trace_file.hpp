#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/frame_timing.hpp"
#include "io/files/line_file.hpp"

namespace motorcade {

/// `trace.json` of a run folder: Chrome trace events in array form, an event per line, for any viewer of such traces.
/// It shows the stages on their threads, decoding ahead, waits, dropped frames and the number in flight. Arrows follow
/// each frame, and link a frame to the next where a stage remembers the previous one. Frames come in order. Every
/// failure is an OutputError naming the file.
class TraceFile {
 public:
  explicit TraceFile(const std::filesystem::path& file);
  void write(const FrameTiming& timing);
  /// Makes the array whole.
  void close();

 private:
  void nameThreads(const FrameTiming& timing);
  void addWork(const FrameTiming& timing);
  void addWaits(const FrameTiming& timing);
  void addArrows(const FrameTiming& timing);
  void addInFlight(const FrameTiming& timing);
  void addMark(const FrameTiming& timing);
  std::string event(std::string_view name, char phase, int thread, SteadyTime at) const;
  void add(const std::string& event);

  LineFile file_;
  std::string lines_;                  // of the frame that is being written
  std::optional<SteadyTime> origin_;   // of the trace's clock: when the first frame was due
  std::set<int> named_;                // threads
  std::vector<SteadyTime> published_;  // of the last frames
  std::optional<FrameTiming> before_;
};

}  // namespace motorcade
