#pragma once

#include <optional>

#include "core/image.hpp"
#include "core/messages.hpp"
#include "core/stereo_camera.hpp"
#include "io/rig/remap.hpp"
#include "motorcade/motorcade.hpp"

namespace motorcade {

/// True when pushed images may have this size.
bool isImageSize(int width_px, int height_px);

/// A caller's camera as the stages need it: that of the rectified pair, and the rectification of its images.
class CameraModel {
 public:
  /// Throws Error naming the field.
  explicit CameraModel(const Camera& camera);

  const StereoCamera& rectified() const { return rectified_; }
  /// The pixels of the rectified left image that are ignored.
  const FrameInputs& inputs() const { return inputs_; }
  /// Rectifies a pushed image, converted to gray, for the stages.
  Image leftOf(const Image& gray, ImagePool& pool) const { return remaps_ ? remaps_->left(gray, pool) : gray; }
  Image rightOf(const Image& gray, ImagePool& pool) const { return remaps_ ? remaps_->right(gray, pool) : gray; }

 private:
  struct Remaps {
    Remap left, right;
  };
  StereoCamera rectified_;
  FrameInputs inputs_;
  std::optional<Remaps> remaps_;
};

/// The accuracy of the calibration, where the caller gives it. Throws Error naming the field.
std::optional<CalibrationSigmas> sigmasOf(const Camera& camera);

/// Converts a rectified pair's camera to the public interface.
Camera cameraOf(const StereoCamera& camera, const std::optional<CalibrationSigmas>& sigmas);

}  // namespace motorcade
