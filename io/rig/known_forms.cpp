#include "io/rig/known_forms.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "io/files/errors.hpp"

namespace motorcade {
namespace {

/// A form that is recognized by its beginning and by texts that it all contains.
struct KnownForm {
  const char* name;
  std::string_view begin;
  std::array<std::string_view, 3> parts;
  const char* advice;
};

constexpr const char* kByPython =
    "write its matrices with OpenCV's cv2.FileStorage('stereo.yml', cv2.FileStorage_WRITE) as M1 D1 M2 D2 R T, and "
    "give stereo.yml";
constexpr const char* kByMatlab =
    "write its values into stereo.yml as M1 D1 M2 D2 R T: IntrinsicMatrix and RotationOfCamera2 transposed, "
    "distortion as k1 k2 p1 p2 k3, TranslationOfCamera2 in meters";
constexpr const char* kByHand = "write its values into stereo.yml as M1 D1 M2 D2 R T, T in meters, and give that";
constexpr const char* kRectified = "give --camera fx,fy,cx,cy,baseline of the rectified images (pixels; meters)";

const std::array kForms{
    KnownForm{"an archive, as NumPy's .npz", "PK\x03\x04", {}, kByPython},
    KnownForm{"an array of NumPy", "\x93NUMPY", {}, kByPython},
    KnownForm{"a pickle of Python", "\x80", {}, kByPython},
    KnownForm{"a file of MATLAB", "MATLAB", {}, kByMatlab},
    KnownForm{"an HDF5 file, as MATLAB's", "\x89HDF", {}, kByMatlab},
    KnownForm{"a script of the Caltech toolbox", "", {"fc_left", "fc_right", "om"}, kByMatlab},
    KnownForm{"Kalibr's report", "", {"Camera-system parameters"}, "give camchain-*.yaml, which Kalibr wrote with it"},
    KnownForm{"a ZED's own calibration, by which its SDK rectifies", "", {"[LEFT_CAM_", "[STEREO]"}, kRectified},
    KnownForm{"a calibration of MRPT", "", {"[CAMERA_PARAMS_LEFT"}, kByHand},
    KnownForm{"ROS' older form (ost.txt, *.ini)",
              "",
              {"camera matrix", "rectification", "projection"},
              "give left.yaml,right.yaml, which lie beside it"},
    KnownForm{"a report of a RealSense, whose infrared images are rectified", "", {"Intrinsic of", "PPX"}, kRectified},
    KnownForm{"DepthAI's (OAK's) own calibration, by which the device rectifies",
              "",
              {"cameraData", "intrinsicMatrix"},
              kRectified},
    KnownForm{"COLMAP's list of cameras", "", {"Camera list with one line of data per camera"}, kByHand},
    KnownForm{"nuScenes' table of cameras, which has no stereo pair",
              "",
              {"camera_intrinsic", "sensor_token"},
              "give the calibration of a pair"},
    KnownForm{"a rig of Isaac (edex)", "", {"distortion_params", "principal", "transform"}, kByHand},
    KnownForm{"OpenVINS' configuration",
              "",
              {"relative_config_imucam"},
              "give the chain that it names, kalibr_imucam_chain.yaml"},
    KnownForm{"DSO's calibration of one camera", "Pinhole ", {}, kRectified},
    KnownForm{"DSO's calibration of one camera", "RadTan ", {}, kRectified},
    KnownForm{"DSO's calibration of one camera", "EquiDistant ", {}, kRectified},
    KnownForm{"DSO's calibration of one camera", "KannalaBrandt ", {}, kRectified}};

bool isOf(const KnownForm& form, std::string_view text) {
  const auto has = [&](std::string_view part) { return text.find(part) != std::string_view::npos; };
  return text.starts_with(form.begin) && std::ranges::all_of(form.parts, has);
}

}  // namespace

void throwKnownForm(const std::filesystem::path& file, std::string_view text) {
  const auto found = std::ranges::find_if(kForms, [&](const KnownForm& form) { return isOf(form, text); });
  if (found == kForms.end()) return;
  throw InputError(file.string() + ": is no calibration that is read: it is " + found->name + "; " + found->advice);
}

}  // namespace motorcade
