#include <array>
#include <string_view>
#include <vector>

#include <fcntl.h>

#include "io/stream/stereo_packing.hpp"
#include "io/stream/y4m_stream.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace motorcade;

namespace {

constexpr std::array<std::string_view, 6> kNoLine{"header", "YUV4MPEG2", "begins", "FRAME", "pixels", "pictures"};

/// Frames up to the stream's end, of headers that do not ask for much memory.
void readFrames(Y4mStream& stream) {
  constexpr std::size_t kMost_bytes = 1 << 20;
  if (stream.header().lumaBytes() > kMost_bytes) return;
  std::vector<std::uint8_t> luma;
  ImagePool pool;
  for (const StereoPacking packing : {StereoPacking::kSideBySide, StereoPacking::kOverUnder}) {
    const ImageSize size = unpackedSize(stream.header(), packing, stream.name());
    if (stream.next(luma) != Y4mStream::Next::kFrame) return;
    const ImagePair pair = unpacked(luma, stream.header().bits, packing, size, pool);
    fuzz::require(pair.right.width() == size.width && pair.right.height() == size.height, "an image of another size");
  }
}

}  // namespace

/// A stream with a few small frames.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::MemoryFile file;
  const int descriptor = ::open(file.holding(fuzz::textOf(data, size)).c_str(), O_RDONLY | O_CLOEXEC);
  fuzz::readOrRefuse("stream", kNoLine, [&] {
    Y4mStream stream(descriptor, "stream");
    readFrames(stream);
  });
  ::close(descriptor);
  return 0;
}
