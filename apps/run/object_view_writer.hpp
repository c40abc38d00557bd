#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "apps/pipeline/pipeline_result.hpp"
#include "core/stereo_camera.hpp"
#include "io/files/line_file.hpp"
#include "io/images/image_file.hpp"

namespace motorcade {

class PartPacker;

/// Packs masks of one size as PNG files. Most of a mask's rows equal the row above, as cells are up to four pixels high
/// and no object reaches over the whole image. The deflated form of such rows is kept and repeated. That takes a
/// quarter of the time in which libpng packs the same image.
class MaskPacker {
 public:
  MaskPacker(int width_px, int height_px);
  ~MaskPacker();
  MaskPacker(const MaskPacker&) = delete;
  MaskPacker& operator=(const MaskPacker&) = delete;

  /// Packs a mask as the bytes of a 16-bit gray PNG. All masks have the size of the first.
  std::string operator()(const Gray16Image& mask);

 private:
  /// A part of the stream that does not refer to others, so that it may stand anywhere.
  struct Part {
    std::string packed;
    std::size_t unpacked_bytes;
    std::uint32_t checksum;
  };
  static Part packed(PartPacker& packer, const std::vector<std::uint8_t>& bytes);
  Part changedRows(const Gray16Image& mask, int first, int end);

  int width_px_, height_px_;
  std::size_t row_bytes_;
  std::unique_ptr<PartPacker> packer_;
  std::vector<Part> repeated_;  // 1, 2, 4, ... rows that equal the row above
};

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
