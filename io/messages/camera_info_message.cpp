#include "io/messages/camera_info_message.hpp"

#include <algorithm>
#include <cmath>

#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"
#include "io/images/image_limits.hpp"
#include "io/rig/rig_parts.hpp"

namespace motorcade {
namespace {

constexpr double kLeastFocal_px = 1, kMostFocal_px = 1e6;

bool isFocal_px(double value) { return value >= kLeastFocal_px && value <= kMostFocal_px; }

/// One side's message with its name for messages.
struct InfoSide {
  const CameraInfoMessage& info;
  const std::string& name;

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(name + ": " + what + "; mend it, or give --camera or --calibration");
  }
};

ImageSize sizeOf(const InfoSide& side) {
  const auto width = side.info.width, height = side.info.height;
  if (width == 0 || height == 0) return {};  // not told
  if (width > kMaxImage_pixels || height > kMaxImage_pixels) side.fail("its width and height are no size of an image");
  return {static_cast<int>(width), static_cast<int>(height)};
}

/// The camera of images that were rectified to P.
LensCamera projectedLens(const InfoSide& side) {
  const auto& P = side.info.P;
  return {.fx_px = P[0], .fy_px = P[5], .cx_px = P[2], .cy_px = P[6], .size = sizeOf(side)};
}

LensCamera rawLens(const InfoSide& side) {
  const auto& K = side.info.K;
  if (!isFocal_px(K[0]) || !isFocal_px(K[4])) side.fail("has no focal lengths in K: the camera is not calibrated");
  LensCamera lens{.fx_px = K[0], .fy_px = K[4], .cx_px = K[2], .cy_px = K[5], .size = sizeOf(side)};
  if (const std::string problem = setDistortion(lens, side.info.distortion_model, side.info.D); !problem.empty())
    side.fail("D " + problem);
  return lens;
}

Eigen::Matrix3d rotationOf(const InfoSide& side) {
  const Eigen::Matrix3d R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(side.info.R.data());
  if (!isRotation(R)) side.fail("R holds no rotation matrix");
  return SE3(R, Eigen::Vector3d::Zero()).normalized().rotation();
}

void requireUsable(const InfoSide& side) {
  const CameraInfoMessage& info = side.info;
  const auto finite = [](const auto& values) {
    return std::ranges::all_of(values, [](double v) { return std::isfinite(v); });
  };
  if (!finite(info.K) || !finite(info.R) || !finite(info.P) || !finite(info.D))
    side.fail("holds what is no finite number");
  if (info.reduced) side.fail("tells of a part of the sensor's image, or of binned pixels, which is not understood");
  if (!isFocal_px(info.P[0]) || !isFocal_px(info.P[5]))
    side.fail("has no focal lengths in P: the cameras are not calibrated as a pair");
}

StereoCamera cameraOf(const InfoSide& left, const InfoSide& right) {
  const auto &P_left = left.info.P, &P_right = right.info.P;
  const StereoCamera camera{.fx_px = P_left[0],
                            .fy_px = P_left[5],
                            .cx_px = P_left[2],
                            .cy_px = P_left[6],
                            .baseline_m = P_left[3] / P_left[0] - P_right[3] / P_left[0]};
  if (camera.baseline_m < 0)
    right.fail("gives a baseline of " + std::to_string(camera.baseline_m) +
               " m: the topics are exchanged; give the left one first");
  if (camera.baseline_m == 0) right.fail("gives no baseline, P[3] is 0: the cameras are not calibrated as a pair");
  return camera;
}

bool isRectifiedFor(const StereoCamera& camera, const LensCamera& lens, const Eigen::Matrix3d& R) {
  constexpr double kSame_px = 1e-6, kSame = 1e-9;
  const auto same = [](double a, double b) { return std::abs(a - b) < kSame_px; };
  return lens.distortion == Distortion::kNone && same(lens.fx_px, camera.fx_px) && same(lens.fy_px, camera.fy_px) &&
         same(lens.cx_px, camera.cx_px) && same(lens.cy_px, camera.cy_px) &&
         (R - Eigen::Matrix3d::Identity()).norm() < kSame;
}

}  // namespace

Rig rigOf(const CameraInfoPair& infos, bool rectified) {
  const InfoSide left{infos.left, infos.left_name}, right{infos.right, infos.right_name};
  for (const InfoSide& side : {left, right}) requireUsable(side);
  Rig rig{.file = infos.left_name,
          .left = rectified ? projectedLens(left) : rawLens(left),
          .right = rectified ? projectedLens(right) : rawLens(right)};
  Rectification given{.left = rig.left, .right = rig.right, .camera = cameraOf(left, right)};
  if (!rectified) given.R_left = rotationOf(left), given.R_right = rotationOf(right);
  if (isRectifiedFor(given.camera, given.left, given.R_left) &&
      isRectifiedFor(given.camera, given.right, given.R_right))
    rig.rectified = given.camera;
  else
    rig.given = given;
  return rig;
}

namespace {

/// The topic without a transport such as `compressed`.
std::string_view withoutTransport(std::string_view topic) {
  constexpr std::string_view kCompressed = "/compressed";
  if (topic.ends_with(kCompressed)) topic.remove_suffix(kCompressed.size());
  return topic;
}

}  // namespace

bool isRectifiedTopic(std::string_view image_topic) {
  const std::string_view topic = withoutTransport(image_topic);
  const auto slash = topic.rfind('/');
  return topic.substr(slash == std::string_view::npos ? 0 : slash + 1).starts_with("image_rect");
}

std::string cameraInfoTopicOf(std::string_view image_topic) {
  const std::string_view topic = withoutTransport(image_topic);
  const auto slash = topic.rfind('/');
  return std::string(topic.substr(0, slash == std::string_view::npos ? 0 : slash + 1)) + "camera_info";
}

}  // namespace motorcade
