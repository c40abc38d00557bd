#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "io/files/text_file.hpp"
#include "io/rig/rig_parts.hpp"
#include "io/rig/rig_readers.hpp"

namespace motorcade {
namespace {

struct BodyCamera {
  LensCamera lens;
  SE3 T_body_cam;
};

Rig rigOfPlaced(const YamlPart& root, const BodyCamera& left, const BodyCamera& right, const std::string& key) {
  return {.file = root.file(),
          .left = left.lens,
          .right = right.lens,
          .T_right_left = betweenPlaced(left.T_body_cam, right.T_body_cam),
          .transform = "the transform by " + key};
}

/// Fails for camera models whose images no pinhole with one of the two distortions can describe.
void requirePinholeModel(const YamlPart& part, std::initializer_list<std::string_view> keys) {
  if (const std::string model = textOr(part, keys, "pinhole"); model != "pinhole" && model != "PINHOLE")
    part.at(keys).fail("is " + printable(model) +
                       ", only pinhole is understood; calibrate anew with Kalibr's "
                       "pinhole-radtan or pinhole-equi");
}

/// One of EuRoC's or Kimera's files.
BodyCamera sensorCamera(const YamlPart& sensor) {
  BodyCamera camera{.lens = {}, .T_body_cam = sensorPlacement(sensor)};
  requirePinholeModel(sensor, {"camera_model"});
  setIntrinsics(camera.lens, sensor.at({"intrinsics"}));
  setDistortion(camera.lens, textOr(sensor, {"distortion_model"}, "none"),
                sensor.at({"distortion_coefficients", "distortion_coeffs"}));
  if (const auto size = sensor.find({"resolution"})) setSize(camera.lens, *size);
  return camera;
}

/// An entry of OKVIS' list.
BodyCamera okvisCamera(const YamlPart& entry) {
  BodyCamera camera{.lens = {}, .T_body_cam = transform44(entry.at({"T_SC"}))};
  const YamlPart focal = entry.at({"focal_length"});
  const auto f = focal.numbers(2), c = entry.at({"principal_point"}).numbers(2);
  setIntrinsics(camera.lens, {f[0], f[1], c[0], c[1]}, focal);
  setDistortion(camera.lens, textOr(entry, {"distortion_type"}, "none"), entry.at({"distortion_coefficients"}));
  if (const auto size = entry.find({"image_dimension"})) setSize(camera.lens, *size);
  return camera;
}

/// An entry of maplab's and SVO's list.
BodyCamera ncameraCamera(const YamlPart& entry) {
  const YamlPart camera = entry.at({"camera"});
  BodyCamera placed{.lens = {}, .T_body_cam = SE3{}};
  requirePinholeModel(camera, {"type"});
  setIntrinsics(placed.lens, camera.at({"intrinsics"}));
  if (const auto distortion = camera.find({"distortion"}))
    setDistortion(placed.lens, textOr(*distortion, {"type"}, "none"), distortion->at({"parameters"}));
  const auto width = camera.find({"image_width"}), height = camera.find({"image_height"});
  if (width && height) placed.lens.size = {imageSide(*width, width->number()), imageSide(*height, height->number())};
  placed.T_body_cam =
      entry.find({"T_C_B"}) ? transform44(entry.at({"T_C_B"})).inverse() : transform44(entry.at({"T_B_C"}));
  return placed;
}

/// Numbers px py pz qx qy qz qw, each under its name.
SE3 basaltPlacement(const YamlPart& part) {
  const auto value = [&](std::string_view key) { return part.at({key}).number(); };
  const Eigen::Quaterniond q(value("qw"), value("qx"), value("qy"), value("qz"));
  constexpr double kRounded = 1e-3;
  if (!(std::abs(q.norm() - 1) < kRounded)) part.fail("has a quaternion that is not of length 1");
  return {q.normalized().toRotationMatrix(), {value("px"), value("py"), value("pz")}};
}

LensCamera basaltLens(const YamlPart& entry) {
  const YamlPart type = entry.at({"camera_type"}), values = entry.at({"intrinsics"});
  const std::string model = type.text();
  const bool fish_eye = model == "kb4";
  if (!fish_eye && model != "pinhole" && model != "pinhole-radtan8")
    type.fail("is " + printable(model) +
              "; pinhole, pinhole-radtan8 and kb4 are understood, calibrate with one of these");
  const auto value = [&](std::string_view key) {
    const auto found = values.find({key});
    return found ? found->number() : 0;
  };
  LensCamera lens;
  setIntrinsics(lens, {value("fx"), value("fy"), value("cx"), value("cy")}, values);
  if (fish_eye)
    setDistortion(lens, "kb4", {value("k1"), value("k2"), value("k3"), value("k4")}, values);
  else
    setDistortion(
        lens, "radtan",
        {value("k1"), value("k2"), value("p1"), value("p2"), value("k3"), value("k4"), value("k5"), value("k6")},
        values);
  return lens;
}

Rig basaltRig(const YamlPart& root) {
  const YamlPart value = root.at({"value0"}), places = value.at({"T_imu_cam"}), lenses = value.at({"intrinsics"});
  const auto place = places.items(), lens = lenses.items();
  if (place.size() < 2 || lens.size() != place.size())
    lenses.fail("and T_imu_cam tell of " + std::to_string(lens.size()) + " and " + std::to_string(place.size()) +
                " cameras; a pair is needed");
  Rig rig = rigOfPlaced(root, {basaltLens(lens[0]), basaltPlacement(place[0])},
                        {basaltLens(lens[1]), basaltPlacement(place[1])}, "T_imu_cam");
  if (const auto sizes = value.find({"resolution"}); sizes && sizes->items().size() == lens.size()) {
    setSize(rig.left, sizes->items()[0]);
    setSize(rig.right, sizes->items()[1]);
  }
  if (lens.size() > 2) rig.remark = "the first two of " + std::to_string(lens.size()) + " cameras";
  return rig;
}

Rig listedRig(const YamlPart& root, const YamlPart& list) {
  const auto entries = list.items();
  if (entries.size() < 2)
    throw OneCameraError(root.file().string() + ": key cameras tells of " + std::to_string(entries.size()) +
                         " camera; a pair is needed");
  const bool okvis = entries.front().find({"T_SC"}).has_value();
  const auto camera = [&](std::size_t i) { return okvis ? okvisCamera(entries[i]) : ncameraCamera(entries[i]); };
  Rig rig = rigOfPlaced(root, camera(0), camera(1), okvis ? "T_SC" : "T_B_C");
  if (entries.size() > 2) rig.remark = "the first two of " + std::to_string(entries.size()) + " cameras";
  return rig;
}

}  // namespace

SE3 sensorPlacement(const YamlPart& sensor) { return transform44(sensor.at({"T_BS"})); }

std::optional<Rig> placedRig(RigParts files) {
  const YamlPart &first = files.front(), &second = files.back();
  if (first.find({"T_BS"}) && first.find({"intrinsics"})) {
    if (files.size() == 1)
      throw OneCameraError(
          first.file().string() +
          ": is the calibration of one camera; give those of both, as cam0/sensor.yaml,cam1/sensor.yaml");
    return rigOfPlaced(first, sensorCamera(first), sensorCamera(second), "T_BS");
  }
  if (first.find({"value0.T_imu_cam"})) return basaltRig(first);
  const auto list = first.find({"cameras"});
  if (list && !list->items().empty() &&
      (list->items().front().find({"T_SC"}) || list->items().front().find({"camera"})))
    return listedRig(first, *list);
  return std::nullopt;
}

}  // namespace motorcade
