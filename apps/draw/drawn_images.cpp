#include "apps/draw/drawn_images.hpp"

#include "io/files/errors.hpp"
#include "io/images/mask_image.hpp"

namespace motorcade {

DrawnImages readDrawnImages(const Sequence& sequence, std::size_t frame, const std::filesystem::path& run_folder,
                            PairReader& reader) {
  DrawnImages images{.left = reader.read(sequence.frames[frame], StereoSide::kLeft)};
  const auto mask = maskFile(run_folder / kMasksFolder, {static_cast<std::int64_t>(frame)});
  if (!std::filesystem::exists(mask)) return images;
  images.mask = readPng16(mask);
  const ImageSize size{images.mask->width, images.mask->height}, wanted{images.left.width(), images.left.height()};
  if (size != wanted)
    throw InputError(mask.string() + ": has " + size.text() + " pixels, the image has " + wanted.text());
  return images;
}

}  // namespace motorcade
