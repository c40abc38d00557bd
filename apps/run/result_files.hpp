#pragma once

#include "apps/inject/fault_spec.hpp"
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

}  // namespace motorcade
