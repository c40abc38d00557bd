#include "apps/check/sequence_remarks.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "io/files/errors.hpp"
#include "io/images/image_file.hpp"

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

/// The least baseline excludes one that was written into P1 without the focal length (0.54 m / 721 px is 0.7 mm, 2 m /
/// 700 px is 2.9 mm). The closest pairs on sale are 18 mm apart (RealSense D405).
/// The largest exceeds the width of road vehicles, 2.55 m; centimeters and millimeters taken for meters lie above it.
constexpr double kLeastBaseline_m = 0.003, kMostBaseline_m = 2.6;
constexpr double kLeastFocal = 0.2, kMostFocal = 10;  // focal length over image width: 136 and 6 degrees wide

/// The principal point as shares of the image's size.
struct Middle {
  double across, down;
};

Middle middleOf(const StereoCamera& camera) {
  return {camera.cx_px / camera.width_px, camera.cy_px / camera.height_px};
}

bool isOutside(const Middle& middle) {
  return middle.across <= 0 || middle.across >= 1 || middle.down <= 0 || middle.down >= 1;
}

bool isFar(double share) { return share < 0.3 || share > 0.7; }

/// True when the calibration seems to be of larger or smaller images, which moves both shares alike. Images with a side
/// cut off, or two in one, move the horizontal share; nobody cuts off so much there. Sky or hood cut off moves the
/// vertical share alone, which is fine.
bool isOfAnotherSize(const Middle& middle) {
  constexpr double kAlike = 0.12;
  const bool both = std::min(middle.across, middle.down) > 0.65 || std::max(middle.across, middle.down) < 0.35;
  return isFar(middle.across) || (both && std::abs(middle.across - middle.down) < kAlike);
}

/// The patterns that one image is suspected of. Color images and unreadable ones are no mosaic.
std::optional<std::string> suspicionOf(const std::filesystem::path& file, const Sequence& sequence, ImagePool& pool) {
  const int sample_bits = sequence.samples ? sequence.samples->bits : kAllSampleBits;
  try {
    return suspectedMosaic(
        decodeImage(readImageBytes(file), file, pool, {.sample_bits = sample_bits, .one_channel = true}));
  } catch (const InputError&) {
    return std::nullopt;
  }
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

std::vector<std::string> doubtsAbout(const StereoCamera& camera) {
  std::vector<std::string> doubts;
  if (!(camera.baseline_m >= kLeastBaseline_m && camera.baseline_m <= kMostBaseline_m))
    doubts.push_back("the calibration tells a baseline of " + fmt::format("{:.4g}", camera.baseline_m) +
                     " m; its translations must be in meters (P1: -fx times the baseline)");
  const double focal = camera.fx_px / camera.width_px;
  if (!(focal >= kLeastFocal && focal <= kMostFocal))
    doubts.push_back(
        fmt::format("the calibration tells a focal length of {:.4g} px for images {} px wide; is it that of "
                    "another image size?",
                    camera.fx_px, camera.width_px));
  const Middle middle = middleOf(camera);
  if (isOutside(middle))
    doubts.push_back(
        fmt::format("the calibration's principal point ({:.5g}, {:.5g}) lies outside the image; is it that of "
                    "another image size?",
                    camera.cx_px, camera.cy_px));
  else if (isOfAnotherSize(middle))
    doubts.push_back(
        fmt::format("the calibration's principal point ({:.5g}, {:.5g}) lies far from the middle of images of "
                    "{}x{} px; is it that of another image size?",
                    camera.cx_px, camera.cy_px, camera.width_px, camera.height_px));
  return doubts;
}

std::vector<std::string> odditiesOf(const StereoCamera& camera) {
  constexpr double kLeastShare = 0.2, kMostShare = 0.8, kMostUnlike = 1.1;
  std::vector<std::string> oddities;
  const Middle middle = middleOf(camera);
  if (!isOutside(middle) && !isOfAnotherSize(middle) && (middle.down < kLeastShare || middle.down > kMostShare))
    oddities.push_back(
        fmt::format("the calibration's principal point lies in row {:.5g} of images {} px high: right where much "
                    "of the sky or the hood is cut off, and cy was lessened by what is cut off above",
                    camera.cy_px, camera.height_px));
  const double unlike = std::max(camera.fx_px, camera.fy_px) / std::min(camera.fx_px, camera.fy_px);
  if (unlike > kMostUnlike)
    oddities.push_back(
        fmt::format("the calibration's focal lengths differ by {:.0f} % (fx {:.5g}, fy {:.5g} px): right where images "
                    "were squeezed; the order is fx, fy, cx, cy",
                    100 * (unlike - 1), camera.fx_px, camera.fy_px));
  return oddities;
}

std::optional<std::string> mosaicDoubt(const Sequence& sequence, const FrameRange& selected, std::size_t pairs) {
  const FrameRange range = selected.within(sequence.frames.size());
  constexpr std::size_t kFirst = 20;
  if (sequence.bayer || range.size() == 0 || pairs == 0) return std::nullopt;
  ImagePool pool;
  std::optional<std::string> patterns;
  const std::size_t count = std::min(range.size(), kFirst), step = std::max<std::size_t>(1, count / pairs);
  for (std::size_t i = 0; i < count; i += step) {
    for (const StereoSide side : {StereoSide::kLeft, StereoSide::kRight}) {
      const auto suspicion = suspicionOf(sequence.frames[range.begin + i].of(side), sequence, pool);
      if (!suspicion || (patterns && *patterns != *suspicion)) return std::nullopt;
      patterns = suspicion;
    }
  }
  return "the gray images look like the mosaic of a color sensor, neighboring pixels see through filters of different "
         "colors: points are less exact; give --bayer, it is " +
         *patterns;
}

}  // namespace motorcade
