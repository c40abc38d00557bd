#include "io/layouts/layout_cameras.hpp"

#include <memory>
#include <string>
#include <utility>

#include "io/files/errors.hpp"
#include "io/rig/rectification.hpp"
#include "io/rig/rig_file.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

/// Moves the right image, so that its middle lies in the column of the left one's.
Rectification movedRight(const StereoCamera& camera, double right_cx_px) {
  LensCamera left{.fx_px = camera.fx_px, .fy_px = camera.fy_px, .cx_px = camera.cx_px, .cy_px = camera.cy_px};
  LensCamera right = left;
  right.cx_px = right_cx_px;
  return {.left = left, .right = right, .camera = camera};
}

void requireRectifiedSize(const Calibration& calibration, CameraPair pair, ImageSize size) {
  const auto told = calibration.rectifiedSize(pair);
  if (told && *told != size)
    throw InputError(calibration.file.string() + ": its projections are of rectified images of " + told->text() +
                     " pixels (S_rect), these have " + size.text() + "; take the rectified images");
}

}  // namespace

StereoCamera projectedCamera(Sequence& sequence, ImageSize size) {
  const Calibration& calibration = sequence.calibration;
  StereoCamera camera = calibration.stereoCamera(sequence.pair);
  requireRectifiedSize(calibration, sequence.pair, size);
  sequence.calibrated_by = calibration.file.string();
  camera.width_px = size.width;
  camera.height_px = size.height;
  if (const double right_cx_px = calibration.rightMiddle_px(sequence.pair); right_cx_px != camera.cx_px)
    sequence.rectification = std::make_shared<const Rectification>(movedRight(camera, right_cx_px));
  return camera;
}

StereoCamera cameraByKitti(Sequence& sequence, Calibration calibration, bool any_pair, ImageSize size) {
  sequence.calibration = std::move(calibration);
  const auto& P = sequence.calibration.P;
  if (any_pair && !P[0] && P[2]) sequence.pair = CameraPair::kColor;
  return projectedCamera(sequence, size);
}

std::optional<StereoCamera> cameraIn(Sequence& sequence, const fs::path& folder, const CameraSearch& search,
                                     ImageSize size) {
  if (const fs::path file = folder / "calib.txt"; fs::exists(file))
    return cameraByKitti(sequence, readCalibration(file), search.any_pair, size);
  if (const auto files = usualRigFiles(folder, search.names); !files.empty())
    return rectifiedCamera(sequence, readRig(files), size);
  return std::nullopt;
}

std::string calibrationsMeant(const fs::path& folder) {
  try {
    if (const auto files = usualRigFiles(folder, RigNames::kAny); !files.empty())
      return "\nOne that lies there under another name is given by\n  " + calibrationArgument(files);
  } catch (const InputError& several) {
    return std::string("\n") + several.what();
  }
  for (const char* name : {"calib_cam_to_cam.txt", "calibration.txt", "perspective.txt"})
    if (fs::exists(folder / name))
      return "\nOne that lies there under another name is given by\n  " + calibrationArgument({folder / name});
  return "";
}

}  // namespace motorcade
