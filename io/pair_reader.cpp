#include "io/pair_reader.hpp"

#include <algorithm>

#include "io/errors.hpp"
#include "io/image_file.hpp"
#include "io/rig/rectification.hpp"

namespace motorcade {

PairReader::PairReader(const Sequence& sequence, int max_file_mb)
    : size_{sequence.camera.width_px, sequence.camera.height_px}, max_file_mb_(max_file_mb) {
  if (!sequence.rectification) return;
  const Rectification& rig = *sequence.rectification;
  remaps_.emplace(
      Remaps{Remap(rig.left, rig.R_left, rig.camera, size_), Remap(rig.right, rig.R_right, rig.camera, size_)});
}

Image PairReader::read(const FramePaths& frame, StereoSide side) {
  if (frame.isMissing(side)) throw InputError(frame.of(side).string() + ": is missing");
  return rectified(readImage(frame.of(side), pool_, size_, max_file_mb_), side);
}

Image PairReader::decode(std::string_view bytes, const std::filesystem::path& name, StereoSide side) {
  return rectified(decodeImage(bytes, name, pool_, size_), side);
}

Image PairReader::rectified(Image raw, StereoSide side) {
  if (!remaps_) return raw;
  return (side == StereoSide::kLeft ? remaps_->left : remaps_->right)(raw, pool_);
}

double PairReader::shareOutside() const {
  return remaps_ ? std::max(remaps_->left.shareOutside(), remaps_->right.shareOutside()) : 0;
}

}  // namespace motorcade
