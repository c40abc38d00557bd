#pragma once

#include <optional>

#include "core/image.hpp"
#include "io/images/image_file.hpp"
#include "io/rig/remap.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// Reads the images of a sequence as the pipeline takes them: gray of 8 bits, and rectified where the files are not.
/// Whoever shows or measures in an image of a sequence reads it by this. The maps are built with it, some milliseconds
/// each.
class PairReader {
 public:
  explicit PairReader(const Sequence& sequence, int max_file_mb = kMaxImageFile_mb);

  /// Throws InputError naming the file.
  Image read(const FramePaths& frame, StereoSide side);
  /// From the bytes of a file; `name` is for messages.
  Image decode(std::string_view bytes, const std::filesystem::path& name, StereoSide side);
  /// An image that came without a file, of the sequence's size.
  Image prepared(Image raw, StereoSide side);
  /// The larger share of either image's pixels for which the camera saw nothing; 0 where nothing is to be rectified.
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
