#include <string>

#include "io/files/text_file.hpp"
#include "io/rig/rig_parts.hpp"
#include "io/rig/rig_readers.hpp"

namespace motorcade {
namespace {

LensCamera kalibrCamera(const YamlPart& part) {
  LensCamera camera;
  if (const std::string model = textOr(part, {"camera_model"}, "pinhole"); model != "pinhole")
    part.at({"camera_model"})
        .fail("is " + printable(model) + ", only pinhole is understood; calibrate anew with pinhole-radtan " +
              "or pinhole-equi");
  setIntrinsics(camera, part.at({"intrinsics"}));
  setDistortion(camera, textOr(part, {"distortion_model"}, "none"),
                part.at({"distortion_coeffs", "distortion_coefficients"}));
  if (const auto size = part.find({"resolution"})) setSize(camera, *size);
  return camera;
}

/// T_imu_cam, from the camera to the inertial unit; empty where the chain does not give it.
std::optional<SE3> kalibrPlacement(const YamlPart& camera) {
  const auto to_camera = camera.find({"T_cam_imu"}), to_imu = camera.find({"T_imu_cam"});
  if (!to_camera && !to_imu) return std::nullopt;
  const SE3 T_imu_cam = to_imu ? transform44(*to_imu) : transform44(*to_camera).inverse();
  if (to_camera && to_imu)
    if (const auto apart = disagreement(T_imu_cam, transform44(*to_camera).inverse()); !apart.empty())
      to_camera->fail("is not the inverse of T_imu_cam: they differ by " + apart + "; leave the one that is right");
  return T_imu_cam;
}

void setKalibrTransform(Rig& rig, const YamlPart& left, const YamlPart& right) {
  const auto direct = right.find({"T_cn_cnm1"});
  const auto T_imu_left = kalibrPlacement(left), T_imu_right = kalibrPlacement(right);
  if (direct) {
    rig.transform = "cam1.T_cn_cnm1";
    rig.T_right_left = transform44(*direct);
    if (!T_imu_left || !T_imu_right) return;
    if (const auto apart = disagreement(rig.T_right_left, betweenPlaced(*T_imu_left, *T_imu_right)); !apart.empty())
      direct->fail("disagrees with what both cameras' T_cam_imu or T_imu_cam say, by " + apart +
                   "; leave those that are right");
    return;
  }
  if (!T_imu_left || !T_imu_right)
    throw InputError(rig.file.string() +
                     ": key cam1.T_cn_cnm1 is missing, and so is T_cam_imu or T_imu_cam of both cameras: nothing tells "
                     "how they stand to each other");
  rig.transform = "T_cam_imu or T_imu_cam of both cameras";
  rig.T_right_left = betweenPlaced(*T_imu_left, *T_imu_right);
}

}  // namespace

std::optional<Rig> kalibrRig(RigParts files) {
  const YamlPart& root = files.front();
  const auto left = root.find({"cam0"}), right = root.find({"cam1"});
  if (!left || !left->find({"intrinsics"})) return std::nullopt;
  if (!right)
    throw OneCameraError(root.file().string() +
                         ": is a chain of one camera, cam0; calibrate both together (cam0 left, cam1 right)");
  Rig rig{.file = root.file(), .left = kalibrCamera(*left), .right = kalibrCamera(*right)};
  setKalibrTransform(rig, *left, *right);
  if (root.find({"cam2"})) rig.remark = "cam0 and cam1 of more cameras";
  return rig;
}

}  // namespace motorcade
