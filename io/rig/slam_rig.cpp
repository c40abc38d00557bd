#include <array>
#include <string>
#include <vector>

#include "io/files/text_file.hpp"
#include "io/rig/rig_parts.hpp"
#include "io/rig/rig_readers.hpp"

namespace motorcade {
namespace {

/// A number under a prefix, as Camera1.fx; `otherwise` where it is missing.
double valueOr(const YamlPart& root, const std::string& key, double otherwise) {
  const auto found = root.find({key});
  return found ? found->number() : otherwise;
}

YamlPart needed(const YamlPart& root, const std::string& key) { return root.at({key}); }

/// The lens under `Camera1.` or the like.
LensCamera settingsLens(const YamlPart& root, const std::string& prefix, bool fish_eye) {
  const auto value = [&](const char* key) { return needed(root, prefix + key).number(); };
  const auto coefficient = [&](const char* key) { return valueOr(root, prefix + key, 0); };
  const YamlPart focal = needed(root, prefix + "fx");
  LensCamera lens;
  setIntrinsics(lens, {value("fx"), value("fy"), value("cx"), value("cy")}, focal);
  if (fish_eye)
    setDistortion(lens, "kb4", {coefficient("k1"), coefficient("k2"), coefficient("k3"), coefficient("k4")}, focal);
  else
    setDistortion(lens, "radtan",
                  {coefficient("k1"), coefficient("k2"), coefficient("p1"), coefficient("p2"), coefficient("k3"),
                   coefficient("k4"), coefficient("k5"), coefficient("k6")},
                  focal);
  return lens;
}

/// The size of the images under the names of either program; empty where it is not told.
ImageSize settingsSize(const YamlPart& root) {
  const auto width = root.find({"Camera.width", "Camera.cols"}), height = root.find({"Camera.height", "Camera.rows"});
  if (!width || !height) return {};
  return {imageSide(*width, width->number()), imageSide(*height, height->number())};
}

/// Baseline, as it stands or times the focal length; empty where neither is told.
std::optional<double> settingsBaseline_m(const YamlPart& root, double fx_px) {
  if (const auto b = root.find({"Stereo.b"})) return b->number();
  if (const auto bf = root.find({"Camera.bf", "Stereo.bf", "Camera.focal_x_baseline"})) return bf->number() / fx_px;
  return std::nullopt;
}

/// The rectified pair that `Camera.` (or `Camera1.`) and the baseline describe.
StereoCamera settingsCamera(const YamlPart& root, const LensCamera& lens) {
  const auto baseline_m = settingsBaseline_m(root, lens.fx_px);
  if (!baseline_m)
    throw OneCameraError(root.file().string() +
                         ": are settings for one camera; a pair needs Camera.bf, Stereo.b, Stereo.T_c1_c2 or "
                         "Camera.focal_x_baseline");
  if (!(*baseline_m > 0))
    throw InputError(root.file().string() +
                     ": the baseline (Stereo.b, Camera.bf / Camera.fx or "
                     "Camera.focal_x_baseline / Camera.fx) must be positive");
  return {
      .fx_px = lens.fx_px, .fy_px = lens.fy_px, .cx_px = lens.cx_px, .cy_px = lens.cy_px, .baseline_m = *baseline_m};
}

/// Names of the keys that hold the rectification of ORB-SLAM2 (LEFT.K) or stella_vslam (StereoRectifier.K_left).
struct RectifierKeys {
  std::array<std::string, 2> K, D, R;
};

LensCamera rectifierLens(const YamlPart& root, const RectifierKeys& keys, std::size_t side, const std::string& model) {
  LensCamera lens;
  setIntrinsics(lens, needed(root, keys.K[side]));
  setDistortion(lens, model, needed(root, keys.D[side]));
  return lens;
}

Rig rectifierRig(const YamlPart& root, const RectifierKeys& keys, const StereoCamera& camera) {
  const std::string model = textOr(root, {"StereoRectifier.model"}, "radtan");
  Rig rig{
      .file = root.file(), .left = rectifierLens(root, keys, 0, model), .right = rectifierLens(root, keys, 1, model)};
  rig.left.size = settingsSize(root);
  rig.given = Rectification{.left = rig.left,
                            .right = rig.right,
                            .R_left = rotation33(needed(root, keys.R[0])),
                            .R_right = rotation33(needed(root, keys.R[1])),
                            .camera = camera};
  return rig;
}

/// Fails where the settings are for other cameras than two that are side by side.
void requireStereo(const YamlPart& root) {
  if (const auto depth = root.find({"DepthMapFactor", "RGBD.DepthMapFactor", "depthmap_factor"}))
    depth->fail("is of an RGB-D camera: its baseline is no pair's; give the calibration of the two cameras");
  if (const auto setup = root.find({"Camera.setup"}); setup && setup->text() != "stereo")
    setup->fail("is " + printable(setup->text()) + "; the calibration of a stereo pair is needed");
  const std::string model = textOr(root, {"Camera.type", "Camera.model"}, "PinHole");
  for (const char* known : {"PinHole", "Pinhole", "Rectified", "KannalaBrandt8", "perspective", "fisheye"})
    if (model == known) return;
  root.at({"Camera.type", "Camera.model"})
      .fail("is " + printable(model) +
            ", which is not understood; calibrate with "
            "PinHole or KannalaBrandt8 (perspective or fisheye)");
}

/// Two lenses and the transform between them: T_c1_c2 takes points of the second camera to the first.
Rig transformRig(const YamlPart& root, const YamlPart& T_left_right, const std::string& first, bool fish_eye) {
  Rig rig{.file = root.file(),
          .left = settingsLens(root, first, fish_eye),
          .right = settingsLens(root, "Camera2.", fish_eye),
          .T_right_left = transform44(T_left_right).inverse(),
          .transform = "the inverse of Stereo.T_c1_c2 (Tlr)"};
  rig.left.size = settingsSize(root);
  return rig;
}

}  // namespace

std::optional<Rig> slamRig(RigParts files) {
  const YamlPart& root = files.front();
  const std::string first = root.find({"Camera1.fx"}) ? "Camera1." : "Camera.";
  if (!root.find({first + "fx"})) return std::nullopt;
  requireStereo(root);
  const std::string model = textOr(root, {"Camera.type", "Camera.model"}, "PinHole");
  const bool fish_eye = model == "KannalaBrandt8" || model == "fisheye";
  if (const auto T_left_right = root.find({"Stereo.T_c1_c2", "Tlr", "T_c1_c2"}))
    return transformRig(root, *T_left_right, first, fish_eye);
  const LensCamera lens = settingsLens(root, first, fish_eye);
  const StereoCamera camera = settingsCamera(root, lens);
  for (const RectifierKeys& keys : {RectifierKeys{{"LEFT.K", "RIGHT.K"}, {"LEFT.D", "RIGHT.D"}, {"LEFT.R", "RIGHT.R"}},
                                    RectifierKeys{{"StereoRectifier.K_left", "StereoRectifier.K_right"},
                                                  {"StereoRectifier.D_left", "StereoRectifier.D_right"},
                                                  {"StereoRectifier.R_left", "StereoRectifier.R_right"}}})
    if (root.find({keys.K[0]})) return rectifierRig(root, keys, camera);
  if (lens.distortion != Distortion::kNone)
    throw InputError(
        root.file().string() +
        ": its cameras distort, and nothing tells how to rectify the pair (LEFT.K "
        "LEFT.D LEFT.R ..., StereoRectifier or Stereo.T_c1_c2); give the calibration that the settings are from");
  LensCamera sized = lens;
  sized.size = settingsSize(root);
  return Rig{.file = root.file(), .left = sized, .right = sized, .rectified = camera};
}

std::optional<Rig> rectifiedRig(RigParts files) {
  const YamlPart& root = files.front();
  const auto intrinsic = root.find({"intrinsic"}), baseline = root.find({"extrinsic.baseline"});
  if (!intrinsic || !baseline || !intrinsic->find({"u0"})) return std::nullopt;
  const auto value = [&](const char* key) { return intrinsic->at({key}).number(); };
  LensCamera lens;
  setIntrinsics(lens, {value("fx"), value("fy"), value("u0"), value("v0")}, *intrinsic);
  const double baseline_m = baseline->number();
  if (!(baseline_m > 0)) baseline->fail("must be positive");
  return Rig{.file = root.file(),
             .left = lens,
             .right = lens,
             .rectified = StereoCamera{.fx_px = lens.fx_px,
                                       .fy_px = lens.fy_px,
                                       .cx_px = lens.cx_px,
                                       .cy_px = lens.cy_px,
                                       .baseline_m = baseline_m}};
}

}  // namespace motorcade
