#pragma once

#include <filesystem>

#include "apps/pipeline/pipeline_result.hpp"
#include "apps/run/mask_packer.hpp"
#include "core/stereo_camera.hpp"
#include "io/files/line_file.hpp"

namespace motorcade {

/// Writes the image's view of the objects (`run --masks`): a mask image per frame, for users who map what rests;
/// outlines as polygons; the followed points. Every failure is an OutputError naming the file.
class ObjectViewWriter {
 public:
  ObjectViewWriter(const std::filesystem::path& run_folder, const StereoCamera& camera);
  void write(const PipelineResult& result);
  void close();

  /// Removes such files of an earlier run, and no others: they would be taken for this run's.
  static void removeEarlier(const std::filesystem::path& run_folder);

 private:
  void writePoints(const FrameMeasurements& measurements);

  std::filesystem::path masks_;
  StereoCamera camera_;
  MaskPacker pack_;
  LineFile outlines_, points_;
};

}  // namespace motorcade
