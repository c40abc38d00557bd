#include "apps/check/sequence_line.hpp"

#include <fmt/format.h>

namespace motorcade {
namespace {

std::string calibrationText(const Sequence& sequence) {
  if (!sequence.given.camera.empty()) return "by --camera";
  const std::string remark = sequence.calibration_remark.empty() ? "" : ": " + sequence.calibration_remark;
  const char* const option = sequence.given.calibration.empty() ? "" : " (--calibration)";
  return "calibration " + sequence.calibrated_by + remark + option;
}

std::string framesText(const Sequence& sequence, const FrameRange& range) {
  if (!sequence.streamed()) return fmt::format("{} of {} frames", range.size(), sequence.frames.size());
  if (range.end == FrameRange{}.end)
    return range.begin == 0 ? "frames as they come" : fmt::format("frames from {} on", range.begin);
  return fmt::format("{} frames", range.size());
}

}  // namespace

std::string sequenceLine(const Sequence& sequence, const FrameRange& range) {
  const StereoCamera& camera = sequence.camera;
  return fmt::format(
      "{}: {} layout, {}, {} x {} px, {}fx {:.2f} fy {:.2f} cx {:.2f} cy {:.2f} px, baseline {:.4f} m, {}",
      sequence.name(), sequence.layout, framesText(sequence, range), camera.width_px, camera.height_px,
      sequence.rectification ? "rectified on the way to " : "", camera.fx_px, camera.fy_px, camera.cx_px, camera.cy_px,
      camera.baseline_m, calibrationText(sequence));
}

}  // namespace motorcade
