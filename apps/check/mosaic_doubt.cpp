#include "apps/check/mosaic_doubt.hpp"

#include <algorithm>

#include "io/files/errors.hpp"
#include "io/images/image_file.hpp"

namespace motorcade {
namespace {

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
