#include "io/images/image_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include <unistd.h>

#include "io/files/errors.hpp"
#include "io/files/file_descriptor.hpp"
#include "io/images/image_codec.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

/// Null when no format has such bytes at its start.
const ImageCodec* codecOf(std::string_view bytes) {
  for (const ImageCodec* codec : {&pngCodec(), &jpegCodec(), &pgmCodec()})
    if (codec->recognizes(bytes)) return codec;
  return nullptr;
}

const ImageCodec& requiredCodecOf(std::string_view bytes, const fs::path& file) {
  if (const ImageCodec* codec = codecOf(bytes)) return *codec;
  failForeign(bytes, file);
}

}  // namespace

bool hasImageName(const fs::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg" || extension == ".pgm" ||
         extension == ".ppm" || extension == ".pnm";
}

ImageFormat imageFormat(const fs::path& file) {
  std::array<char, 8> start{};
  try {
    const InputFile in = openInput(file);
    const ssize_t got = ::read(in.descriptor.number(), start.data(), start.size());
    const ImageCodec* codec = codecOf({start.data(), static_cast<std::size_t>(std::max<ssize_t>(got, 0))});
    return codec ? codec->format : ImageFormat::kUnknown;
  } catch (const InputError&) {
    return ImageFormat::kUnknown;
  }
}

ImageHeader parseImageHeader(std::string_view bytes, const fs::path& name) {
  return requiredCodecOf(bytes, name).header(bytes, name);
}

ImageHeader readImageHeader(const fs::path& file) { return parseImageHeader(readImageBytes(file), file); }

ImageSize readImageSize(const fs::path& file) { return readImageHeader(file).size; }

int brightestSampleIn(std::string_view bytes, const fs::path& name) {
  const ImageCodec& codec = requiredCodecOf(bytes, name);
  return codec.header(bytes, name).bits == kAllSampleBits ? codec.brightest(bytes, name) : 0;
}

int readBrightestSample(const fs::path& file) { return brightestSampleIn(readImageBytes(file), file); }

Image readImage(const fs::path& file, ImagePool& pool, std::optional<ImageSize> expected, int max_mb) {
  return decodeImage(readImageBytes(file, max_mb), file, pool, {.size = expected});
}

Image decodeImage(std::string_view bytes, const fs::path& name, ImagePool& pool, const ExpectedImage& expected) {
  const ImageCodec& codec = requiredCodecOf(bytes, name);
  const ImageHeader header = codec.header(bytes, name);
  if (expected.size && header.size != *expected.size)
    throw InputError(name.string() + ": has " + header.size.text() + " pixels, the sequence has " +
                     expected.size->text());
  if (expected.one_channel && header.channels != 1) throw InputError(name.string() + kNoMosaic);
  return codec.decode(bytes, name, pool, expected.sample_bits);
}

}  // namespace motorcade
