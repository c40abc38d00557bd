#include <cstddef>
#include <cstdio>
#include <exception>
#include <string>

#include "core/image.hpp"
#include "io/files/errors.hpp"
#include "io/images/image_file.hpp"
#include "io/images/png_fast_decoder.hpp"
#include "io/layouts/open_sequence.hpp"
#include "io/sequence/sequence.hpp"

/// Decodes the first pairs of a drive by libpng alone: under callgrind, `decodeAnyPng` is the unit of costs there.
///   libpng_pairs DRIVE FRAMES
int main(int argc, char** argv) try {
  using namespace motorcade;
  if (argc != 3) throw UsageError("libpng_pairs DRIVE FRAMES");
  const Sequence drive = openSequence(argv[1]);
  const FrameRange range = parseFrameRange(std::string(":") + argv[2]).within(drive.frames.size());
  ImagePool pool;
  for (std::size_t i = range.begin; i < range.end; ++i)
    for (const StereoSide side : {StereoSide::kLeft, StereoSide::kRight}) {
      const auto& file = drive.frames[i].of(side);
      decodeAnyPng(readImageBytes(file), file, pool);
    }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
