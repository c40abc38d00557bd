#include "apps/view/sequence_pictures.hpp"

#include "io/files/errors.hpp"
#include "io/images/image_file.hpp"

namespace motorcade {

std::shared_ptr<const std::string> SequencePictures::jpeg(std::int64_t frame) {
  if (frame < 0 || frame >= std::ssize(sequence_.frames)) return nullptr;
  const std::scoped_lock lock(one_at_a_time_);
  try {
    const Image left = reader_.read(sequence_.frames[static_cast<std::size_t>(frame)], StereoSide::kLeft);
    return std::make_shared<const std::string>(encodeJpeg(left, kPageJpegQuality));
  } catch (const InputError&) {  // the frame was rejected; the page says so
    return nullptr;
  }
}

}  // namespace motorcade
