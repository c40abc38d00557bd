#include "io/stream/stream_sequence.hpp"

#include "io/files/errors.hpp"
#include "io/images/image_file.hpp"
#include "io/layouts/given_cameras.hpp"
#include "io/layouts/sample_use.hpp"

namespace motorcade {
namespace {

constexpr const char* kInterlaced =
    "its pictures are interlaced: every second row is of another moment; deinterlace them first, as by ffmpeg's -vf "
    "yadif";

/// None where the pictures are gray or have colors.
std::optional<BayerPattern> mosaicOfStream(const Sequence& sequence, const Y4mHeader& header) {
  const auto pattern = mosaicOf(sequence, sequence.given);
  if (pattern && header.chroma_samples > 0) throw InputError(sequence.name() + kNoMosaic);
  return pattern;
}

}  // namespace

Sequence sequenceOfStream(const Y4mHeader& header, StereoPacking packing, const GivenCameras& given) {
  Sequence sequence{.folder = kStandardInput};
  sequence.layout = packing == StereoPacking::kSideBySide ? "y4m_side_by_side" : "y4m_over_under";
  const ImageSize size = unpackedSize(header, packing, sequence.name());
  sequence.given = absolute(given);
  sequence.camera = givenCamera(sequence, sequence.given, size);
  sequence.camera.width_px = size.width;
  sequence.camera.height_px = size.height;
  if (header.bits > 8)
    sequence.samples = {header.bits, "taken as " + std::to_string(header.bits) + " bits: the stream's header tells so"};
  sequence.bayer = mosaicOfStream(sequence, header);
  if (header.interlaced) sequence.notes.push_back({.name = "images", .text = kInterlaced, .worthless = true});
  return sequence;
}

}  // namespace motorcade
