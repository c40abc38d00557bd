#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "apps/export/exported_frame.hpp"
#include "apps/export/frame_messages.hpp"
#include "apps/export/mcap_writer.hpp"

namespace motorcade {

/// Writes a drive as an MCAP file for Foxglove and Rerun (docs/formats.md). Frames come in order. Every failure
/// is an OutputError naming the file.
class DriveMcap {
 public:
  DriveMcap(const std::filesystem::path& file, const StereoCamera& camera);

  void write(const ExportedFrame& frame);
  /// Writes the index. Without it the file is readable up to its last whole chunk.
  void close() { writer_.close(); }

  std::uint64_t bytes() const { return writer_.bytes(); }

 private:
  void writePath(const FrameEstimate& estimate);

  mcap::Writer writer_;
  StereoCamera camera_;
  mcap::ChannelId image_, calibration_, transforms_, pose_, path_, objects_, points_, diagnostics_;
  SceneMessages scene_;
  std::vector<SE3> way_;  // of the camera, every `stride_`th frame
  std::size_t stride_ = 1, frames_ = 0;
  std::int64_t path_second_ = -1;  // in which it was written last
};

}  // namespace motorcade
