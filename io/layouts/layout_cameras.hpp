#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "io/layouts/layout_parts.hpp"
#include "io/rig/rig_search.hpp"

/// Cameras from the calibrations that layouts have.
namespace motorcade {

/// The camera by the sequence's `calibration`. Where the middles of the two images differ, the right image is moved
/// while it is read. Throws InputError.
StereoCamera projectedCamera(Sequence& sequence, ImageSize size);
/// Options of the search for a sequence's camera, set by its names and files.
struct CameraSearch {
  bool any_pair = false;  // the images' folders do not tell which pair of KITTI's it is: gray if there is one
  RigNames names = RigNames::kUsual;
};

/// The camera from a folder: by calib.txt, or else by a calibration of a pair that is not rectified. Empty where it has
/// neither.
std::optional<StereoCamera> cameraIn(Sequence& sequence, const std::filesystem::path& folder,
                                     const CameraSearch& search, ImageSize size);
/// Takes the camera from a calibration in KITTI's form.
StereoCamera cameraByKitti(Sequence& sequence, Calibration calibration, bool any_pair, ImageSize size);

/// The end of a message that the calibration is missing: files in the folder that may be meant; often empty.
std::string calibrationsMeant(const std::filesystem::path& folder);

}  // namespace motorcade
