#include "io/inputs/pair_reader.hpp"

#include <algorithm>
#include <utility>

#include "io/files/errors.hpp"
#include "io/images/image_file.hpp"
#include "io/rig/rectification.hpp"

namespace motorcade {

PairReader::PairReader(const Sequence& sequence, int max_file_mb)
    : expected_{.size = ImageSize{sequence.camera.width_px, sequence.camera.height_px},
                .sample_bits = sequence.samples ? sequence.samples->bits : kAllSampleBits,
                .one_channel = sequence.bayer.has_value()},
      bayer_(sequence.bayer),
      max_file_mb_(max_file_mb) {
  if (!sequence.rectification) return;
  const Rectification& rig = *sequence.rectification;
  const ImageSize size = *expected_.size;
  remaps_.emplace(
      Remaps{Remap(rig.left, rig.R_left, rig.camera, size), Remap(rig.right, rig.R_right, rig.camera, size)});
}

Image PairReader::read(const FramePaths& frame, StereoSide side) {
  const auto& file = frame.of(side);
  if (frame.isMissing(side)) throw InputError(file.string() + ": is missing");
  return decode(readImageBytes(file, max_file_mb_), file, side);
}

Image PairReader::decode(std::string_view bytes, const std::filesystem::path& name, StereoSide side) {
  return prepared(decodeImage(bytes, name, pool_, expected_), side);
}

Image PairReader::prepared(Image raw, StereoSide side) {
  if (bayer_) raw = grayOfMosaic(raw, *bayer_, pool_);
  if (!remaps_) return raw;
  return (side == StereoSide::kLeft ? remaps_->left : remaps_->right)(raw, pool_);
}

double PairReader::shareOutside() const {
  return remaps_ ? std::max(remaps_->left.shareOutside(), remaps_->right.shareOutside()) : 0;
}

}  // namespace motorcade
