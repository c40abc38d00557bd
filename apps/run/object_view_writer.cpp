#include "apps/run/object_view_writer.hpp"

#include "io/files/file_descriptor.hpp"
#include "io/images/mask_image.hpp"
#include "io/results/object_points.hpp"
#include "io/results/outline_polygons.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOutlinesFile = "outlines.jsonl";

/// True for a mask, also one that a killed run left unfinished.
bool isOfMasks(const fs::path& file) {
  return isMaskFile(file.extension() == kUnfinishedSuffix ? file.parent_path() / file.stem() : file);
}

fs::path preparedMasks(const fs::path& folder) {
  makeFolder(folder);
  return folder;
}

}  // namespace

void ObjectViewWriter::removeEarlier(const fs::path& run_folder) {
  std::error_code ignored;
  for (const char* file : {kOutlinesFile, kObjectPointsFile}) fs::remove(run_folder / file, ignored);
  for (const auto& entry : fs::directory_iterator(run_folder / kMasksFolder, ignored))
    if (isOfMasks(entry.path())) fs::remove(entry.path(), ignored);
}

ObjectViewWriter::ObjectViewWriter(const fs::path& run_folder, const StereoCamera& camera)
    : masks_(preparedMasks(run_folder / kMasksFolder)),
      camera_(camera),
      pack_(camera.width_px, camera.height_px),
      outlines_(run_folder / kOutlinesFile),
      points_(run_folder / kObjectPointsFile) {
  points_.writeLine(kObjectPointsHeader);
}

void ObjectViewWriter::write(const PipelineResult& result) {
  const FrameEstimate& frame = result.online;
  const int width_px = camera_.width_px, height_px = camera_.height_px;
  writeBytesAtOnce(maskFile(masks_, frame.head.frame), pack_(maskImage(frame, result.masks, width_px, height_px)));
  std::vector<std::string> lines;
  for (const ObjectMask& mask : result.masks)
    lines.push_back(outlineLine(frame.head.frame, mask.track, outlinePolygons(mask, width_px, height_px)));
  outlines_.writeLines(lines);
  if (result.measurements) writePoints(*result.measurements);
}

void ObjectViewWriter::writePoints(const FrameMeasurements& measurements) {
  std::vector<std::string> lines;
  for (const ObjectObservation& seen : measurements.objects) {
    if (seen.frame != measurements.head.frame) continue;  // from before it was confirmed
    for (const PointMeasurement& point : seen.measured)
      lines.push_back(objectPointLine(
          {.frame = seen.frame, .track = seen.track, .point = point.point, .uvd_px = point.uvd_px.cast<double>()}));
  }
  points_.writeLines(lines);
}

void ObjectViewWriter::close() {
  outlines_.close();
  points_.close();
}

}  // namespace motorcade
