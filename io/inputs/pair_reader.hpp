#pragma once

#include <optional>

#include "core/image.hpp"
#include "io/images/image_file.hpp"
#include "io/rig/remap.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// Reads the images of a sequence as the pipeline takes them: gray of 8 bits, and rectified where the files are not.
/// Commands that show images or measure in them use it, too. The constructor builds the maps, which takes some
/// milliseconds each.
class PairReader {
 public:
  explicit PairReader(const Sequence& sequence, int max_file_mb = kMaxImageFile_mb);

  /// Throws InputError naming the file.
  Image read(const FramePaths& frame, StereoSide side);
  /// Decodes the bytes of a file; `name` is for messages.
  Image decode(std::string_view bytes, const std::filesystem::path& name, StereoSide side);
  /// Prepares an image that came without a file and has the sequence's size.
  Image prepared(Image raw, StereoSide side);
  /// Share of the pixels that the camera did not see, of the image with more of them; 0 where nothing is rectified.
  double shareOutside() const;

 private:
  struct Remaps {
    Remap left, right;
  };
  ExpectedImage expected_;
  std::optional<BayerPattern> bayer_;
  int max_file_mb_;
  std::optional<Remaps> remaps_;
  ImagePool pool_;
};

}  // namespace motorcade
