#include "apps/run/object_view_writer.hpp"

#include "io/errors.hpp"
#include "io/mask_image.hpp"
#include "io/object_points.hpp"
#include "io/outline_polygons.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOutlinesFile = "outlines.jsonl";

fs::path preparedMasks(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw OutputError(folder.string() + ": cannot be made a folder: " + error.message());
  return folder;
}

}  // namespace

void ObjectViewWriter::removeEarlier(const fs::path& run_folder) {
  std::error_code ignored;
  for (const char* file : {kOutlinesFile, kObjectPointsFile}) fs::remove(run_folder / file, ignored);
  for (const auto& entry : fs::directory_iterator(run_folder / kMasksFolder, ignored))
    if (isMaskFile(entry.path())) fs::remove(entry.path(), ignored);
}

ObjectViewWriter::ObjectViewWriter(const fs::path& run_folder, const StereoCamera& camera)
    : masks_(preparedMasks(run_folder / kMasksFolder)),
      camera_(camera),
      outlines_(run_folder / kOutlinesFile),
      points_(run_folder / kObjectPointsFile) {
  points_.writeLine(kObjectPointsHeader);
}

void ObjectViewWriter::frameLeft(const PipelineResult& result) {
  const FrameEstimate& frame = result.online;
  writePng16(maskFile(masks_, frame.frame), maskImage(frame, result.masks, camera_.width_px, camera_.height_px));
  for (const ObjectMask& mask : result.masks)
    outlines_.writeLine(
        outlineLine(frame.frame, mask.track, outlinePolygons(mask, camera_.width_px, camera_.height_px)));
  if (!result.measurements) return;
  for (const ObjectObservation& seen : result.measurements->objects) {
    if (seen.frame != frame.frame) continue;  // from before it was confirmed
    for (const PointMeasurement& point : seen.measured)
      points_.writeLine(objectPointLine(
          {.frame = frame.frame, .track = seen.track, .point = point.point, .uvd_px = point.uvd_px.cast<double>()}));
  }
}

void ObjectViewWriter::close() {
  outlines_.close();
  points_.close();
}

}  // namespace motorcade
