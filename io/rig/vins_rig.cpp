#include <string>

#include "io/files/text_file.hpp"
#include "io/rig/rig_parts.hpp"
#include "io/rig/rig_readers.hpp"

namespace motorcade {
namespace {

LensCamera vinsLens(const YamlPart& camera) {
  const YamlPart type = camera.at({"model_type"}), values = camera.at({"projection_parameters"});
  const auto value = [&](const char* key) { return values.at({key}).number(); };
  LensCamera lens;
  if (type.text() == "PINHOLE") {
    setIntrinsics(lens, {value("fx"), value("fy"), value("cx"), value("cy")}, values);
    const YamlPart distortion = camera.at({"distortion_parameters"});
    const auto k = [&](const char* key) { return distortion.at({key}).number(); };
    setDistortion(lens, "radtan", {k("k1"), k("k2"), k("p1"), k("p2")}, distortion);
  } else if (type.text() == "KANNALA_BRANDT") {
    setIntrinsics(lens, {value("mu"), value("mv"), value("u0"), value("v0")}, values);
    setDistortion(lens, "kb4", {value("k2"), value("k3"), value("k4"), value("k5")}, values);
  } else {
    type.fail("is " + printable(type.text()) +
              "; PINHOLE and KANNALA_BRANDT are understood, calibrate with one of these");
  }
  const auto width = camera.find({"image_width"}), height = camera.find({"image_height"});
  if (width && height) lens.size = {imageSide(*width, width->number()), imageSide(*height, height->number())};
  return lens;
}

/// Reads a camera from the file that the configuration names, relative to the configuration's folder.
LensCamera vinsCamera(const YamlPart& name) {
  constexpr std::size_t kMostTold = 300;
  std::string problem;
  try {
    return vinsLens(YamlPart::ofFile(name.file().parent_path() / name.text()));
  } catch (const InputError& error) {
    problem = error.what();
  }
  name.fail("names what cannot be used: " + printable(problem, kMostTold));
}

}  // namespace

std::optional<Rig> vinsRig(RigParts files) {
  const YamlPart& root = files.front();
  if (root.find({"model_type"}) && root.find({"projection_parameters"}))
    throw OneCameraError(root.file().string() +
                         ": is VINS' calibration of one camera; give the configuration that names it as cam0_calib and "
                         "has body_T_cam0 and body_T_cam1");
  const auto left = root.find({"cam0_calib"});
  if (!left) return std::nullopt;
  const auto right = root.find({"cam1_calib"});
  if (!right) throw OneCameraError(root.file().string() + ": names one camera, cam0_calib; a pair has cam1_calib, too");
  if (const auto unknown = root.find({"estimate_extrinsic"}); unknown && unknown->number() == 2)
    unknown->fail("is 2: body_T_cam0 and body_T_cam1 are not known; give a calibration that has them");
  return Rig{
      .file = root.file(),
      .left = vinsCamera(*left),
      .right = vinsCamera(*right),
      .T_right_left = betweenPlaced(transform44(root.at({"body_T_cam0"})), transform44(root.at({"body_T_cam1"}))),
      .transform = "the transform by body_T_cam0 and body_T_cam1"};
}

}  // namespace motorcade
