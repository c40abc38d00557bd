#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

#include "apps/inject/fault_spec.hpp"
#include "apps/pipeline/pipeline_params.hpp"
#include "apps/pipeline/pipeline_result.hpp"
#include "apps/run/object_view_writer.hpp"
#include "io/results/run_folder.hpp"

namespace motorcade {

/// A result on its way to the files; without a frame it brings only frames that were dropped, and final estimates.
struct WrittenResult {
  PipelineResult result;  // `timing.due` stands for when the dropped frames were due, which nobody knows
  bool has_frame = true;
  bool has_view = true;  // its masks and points are to be written, where the user wants them
};

/// Writes results to the run folder, and what the images show of the objects beside it. Refers to the writers. Every
/// failure is an OutputError naming the file.
class ResultFiles {
 public:
  /// `views` is null where the user wants none. The faults may make the disk stall.
  ResultFiles(RunFolderWriter& folder, ObjectViewWriter* views, FaultSpec faults);

  bool hasViews() const { return views_ != nullptr; }
  void write(const WrittenResult& written) const;

 private:
  void writeDropped(const PipelineResult& result) const;
  void writeFrame(const PipelineResult& result, bool with_view) const;

  RunFolderWriter& folder_;
  ObjectViewWriter* views_;
  FaultSpec faults_;
};

/// Takes results to their files on a thread of its own, in order, so that a disk that stalls holds up no frame. What
/// waits is bounded: first the views of frames are left out, which need most memory, then whoever brings a result
/// waits.
class WriteQueue {
 public:
  using Write = std::function<void(const WrittenResult&)>;
  struct Bounds {
    std::size_t results, with_views;  // as many may wait, and of them with what they show in the image
  };
  /// Results that waited for the disk.
  struct Load {
    std::size_t high_water = 0, bound = 0;  // results
    std::int64_t views_left_out = 0;        // frames
    std::int64_t waits = 0;                 // results that found no room
    double waited_s = 0;                    // for it, in all
  };
  /// A live run has room for the seconds in which a disk may stall; a replay, which waits for its files, for few.
  static Bounds boundsOf(InputPolicy policy);

  WriteQueue(Write write, const Bounds& bounds);
  /// Writes what waits, and keeps to itself what goes wrong meanwhile.
  ~WriteQueue();
  WriteQueue(const WriteQueue&) = delete;
  WriteQueue& operator=(const WriteQueue&) = delete;

  /// Throws what writing has thrown so far, after which nothing more is written.
  void push(WrittenResult written);
  /// Waits until all is written; throws what writing threw. Nothing may be pushed any more.
  void close();

  /// Complete after `close`.
  const Load& load() const { return load_; }

 private:
  void waitForRoom(std::unique_lock<std::mutex>& lock);
  void writeAll();
  void end();

  Write write_;
  Bounds bounds_;
  std::mutex mutex_;  // of all below
  std::condition_variable pushed_, popped_;
  std::deque<WrittenResult> waiting_;
  bool ending_ = false;
  Load load_;
  std::exception_ptr failure_;
  std::jthread thread_;  // last: it uses all of the above
};

}  // namespace motorcade
