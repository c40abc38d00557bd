#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/stereo_camera.hpp"
#include "core/timestamp.hpp"
#include "io/images/bayer.hpp"
#include "io/images/sample_bits.hpp"
#include "io/sequence/calibration.hpp"

namespace motorcade {

struct Rectification;

enum class StereoSide { kLeft, kRight };

/// The images of a frame. A missing one has the name that it should have.
struct FramePaths {
  std::filesystem::path left, right;
  bool left_missing = false, right_missing = false;

  const std::filesystem::path& of(StereoSide side) const { return side == StereoSide::kLeft ? left : right; }
  bool isMissing(StereoSide side) const { return side == StereoSide::kLeft ? left_missing : right_missing; }
  bool isPair() const { return !left_missing && !right_missing; }
};

/// A note to the user about a sequence, in one sentence.
struct InputNote {
  std::string name;  // as of a finding in docs/formats.md: pairs, times or images
  std::string text;
  bool worthless = false;  // results would be
};

/// The numbers of the images as their names give them.
struct Numbering {
  std::int64_t first = 0, step = 1;    // of the numbers
  std::vector<std::int64_t> places{};  // of each frame: (number - first) / step; empty where they are 0, 1, 2, ...
};

/// A half-open range of frames, cut to a sequence's length by `within`.
struct FrameRange {
  std::size_t begin = 0, end = static_cast<std::size_t>(-1);

  FrameRange within(std::size_t count) const { return {begin < count ? begin : count, end < count ? end : count}; }
  std::size_t size() const { return end > begin ? end - begin : 0; }
};

/// Reads `A:B`, `A:` or `:B`; throws UsageError.
FrameRange parseFrameRange(std::string_view text);

/// Camera data given by the user where the sequence's own files have none; at most one of the first two is set.
struct GivenCameras {
  std::string camera{};       // fx,fy,cx,cy,baseline of a rectified pair [px, m]
  std::string calibration{};  // FILE, or two as LEFT,RIGHT
  std::string bayer{};        // the pattern of images that are a color sensor's mosaic

  /// True when nothing describes the cameras' geometry.
  bool empty() const { return camera.empty() && calibration.empty(); }
};

/// The conversion of 16-bit samples to gray, the same for all images of a drive.
struct SampleUse {
  int bits = kAllSampleBits;  // that they use, see `upperBits`
  std::string why{};          // after "16-bit images, "
};

/// The user's word for a stream of pairs on the standard input, in place of a folder.
inline constexpr const char* kStandardInput = "-";

/// The layout of a drive whose pairs are in a bag.
inline constexpr const char* kBagLayout = "bag";

/// A recorded drive: its images, their capture times, its camera, and its ground truth. A pipe (`kStandardInput`) and a
/// bag bring their pairs one by one, so that these have neither frames nor stamps.
struct Sequence {
  /// Files with ground truth; an empty path where there is none.
  struct Truth {
    std::filesystem::path poses{};             // KITTI pose lines of the left gray camera
    std::filesystem::path labels{};            // KITTI label_02
    std::filesystem::path object_poses{};      // as in rendered sequences
    std::filesystem::path instances{};         // folder of masks with the labels' numbers plus one, of rendered ones
    std::filesystem::path oxts{};              // a file with a line per packet, or a folder with a file per packet
    std::filesystem::path oxts_timestamps{};   // capture time of each packet
    std::filesystem::path image_timestamps{};  // capture time of each image, on the same clock
    std::filesystem::path stamped_poses{};     // EuRoC's table of poses by time, on the images' clock
    std::filesystem::path numbered_poses{};    // KITTI-360's poses by the number in the image's name
    std::filesystem::path virtual_kitti{};     // folder with the tables of a variation of Virtual KITTI 2
    SE3 T_posed_cam{};                         // the pair's left camera, seen from what either of these is about

    /// Poses of camera and objects are those that the images were rendered with, not of another instrument.
    bool exact() const { return !object_poses.empty() || !virtual_kitti.empty(); }
  };

  /// The drive's name in messages.
  std::string name() const { return piped() ? "standard input" : folder.string(); }
  bool piped() const { return folder == kStandardInput; }
  bool streamed() const { return piped() || layout == kBagLayout; }

  std::filesystem::path folder{};
  /// plain, odometry, tracking, raw, euroc, kitti360, virtual_kitti, argoverse, list, y4m_side_by_side, y4m_over_under
  /// or bag
  std::string layout{};
  CameraPair pair = CameraPair::kGray;
  Calibration calibration{};
  StereoCamera camera{};  // with the size of the images
  std::vector<FramePaths> frames{};
  Numbering numbering{};
  std::int64_t left_out = 0;        // images that belong to no frame
  std::vector<InputNote> notes{};   // to be read before the first frame
  std::vector<Timestamp> stamps{};  // one per frame, strictly increasing
  bool stamps_measured = false;     // read from a file or the images' names, not made from the frame rate
  Truth truth{};
  std::shared_ptr<const Rectification> rectification{};  // none where the images are rectified
  std::optional<SampleUse> samples{};                    // none where the images have 8 bits
  std::optional<BayerPattern> bayer{};                   // none where they are gray or have colors
  GivenCameras given{};                                  // with absolute paths
  std::string calibrated_by{};       // the calibration in force: FILE or LEFT,RIGHT; empty where --camera tells
  std::string calibration_remark{};  // which of its cameras were taken, where it has more than two
};

/// The frames of a sequence that an option --frames names, all of them where it is empty. Throws UsageError where there
/// are none.
FrameRange selectedFrames(std::string_view text, const Sequence& sequence);

}  // namespace motorcade
