#pragma once

#include <filesystem>
#include <functional>

#include "apps/synth/rendering/renderer.hpp"
#include "apps/synth/scenes/scene.hpp"

namespace motorcade::synth {

/// Errors by which the images of a rig disagree with its calibration.
struct RigError {
  double disparity_offset_px = 0;  // true minus measured disparity: the right image's content lies too far right
  double row_offset_px = 0;        // the right image's content lies too low
  /// Scale of constant errors that are drawn with the scene's seed from a normal distribution. At 1 they have the
  /// standard deviations of a rig that was calibrated with care (CalibrationSigmas).
  double calibration = 0;
  double shake_px = 0;  // standard deviation of an error that all disparities of a pair share

  bool operator==(const RigError&) const = default;
};

struct WriteOptions {
  int frames = 0;  // 0: as many as the scene has
  bool with_movers = true;
  StereoCamera camera = kittiCamera();
  RigError rig_error;
  bool vehicle_motion = false;  // what the car's sensors tell of it is written, too
  RenderOptions render;
  std::function<void(int done, int frames)> progress;  // called after each frame
};

/// Renders a scene into a folder in the plain KITTI layout, ground truth included. Calibration and truth are those of
/// the camera without the rig's error. The calibration states where it is exact. Throws OutputError, naming the file,
/// when something cannot be written.
void writeSequence(const Scene& scene, const std::filesystem::path& folder, const WriteOptions& options);

}  // namespace motorcade::synth
