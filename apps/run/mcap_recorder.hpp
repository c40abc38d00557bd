#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include "apps/export/drive_mcap.hpp"
#include "apps/pipeline/pipeline_result.hpp"
#include "core/stereo_camera.hpp"

namespace motorcade {

/// Writes a run as an MCAP file while it goes on (`run --mcap`). Encoding and writing are done on a thread of its own.
/// The recorder leaves out first the images of frames, then whole frames, if that thread falls behind a live camera,
/// and counts both. A replay waits for it instead.
class McapRecorder : public RunListener {
 public:
  enum class Behind { kWait, kLeaveOut };
  struct LeftOut {
    std::int64_t images = 0, frames = 0;
  };

  McapRecorder(const std::filesystem::path& file, const StereoCamera& camera, Behind behind);
  /// Leaves the file as it is, like one that was cut off, unless it was closed.
  ~McapRecorder() override;

  void frameEntered(const StereoFrame& frame) override;
  /// Throws the OutputError of the writing thread.
  void frameLeft(const PipelineResult& result) override;
  /// Writes the waiting frames and ends the file. Throws OutputError.
  void close();

  /// Counts of what was left out; valid after `close`.
  LeftOut leftOut() const { return left_out_; }
  std::uint64_t bytes() const { return out_.bytes(); }

 private:
  struct Waiting {
    FrameEstimate estimate;
    FrameMeasurementsPtr measurements;
    FrameTiming timing;
    bool with_image = true;
  };
  void enqueue(const PipelineResult& result);
  void writeAll(const std::stop_token& stopped);
  std::optional<Waiting> next(const std::stop_token& stopped);
  Image imageOf(FrameId frame);
  ExportedFrame exported(const Waiting& waiting);
  void throwFailure();

  DriveMcap out_;
  StereoCamera camera_;
  Behind behind_;
  std::mutex mutex_;  // of all below
  std::condition_variable_any changed_;
  std::map<FrameId, Image> images_;  // of frames that entered and have not been written
  FrameId last_entered_;
  std::deque<Waiting> waiting_;
  bool ending_ = false;
  LeftOut left_out_;
  std::exception_ptr failure_;
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace motorcade
