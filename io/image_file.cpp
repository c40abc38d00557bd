#include "io/image_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include <unistd.h>

#include "io/errors.hpp"
#include "io/file_descriptor.hpp"
#include "io/image_codec.hpp"

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
  throw InputError(file.string() + ": is neither PNG, JPEG nor PGM" + (bytes.empty() ? "; the file is empty" : ""));
}

}  // namespace

bool hasImageName(const fs::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg" || extension == ".pgm";
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

ImageSize readImageSize(const fs::path& file) {
  const std::string bytes = readImageBytes(file);
  return requiredCodecOf(bytes, file).size(bytes, file);
}

Image readImage(const fs::path& file, ImagePool& pool, std::optional<ImageSize> expected, int max_mb) {
  return decodeImage(readImageBytes(file, max_mb), file, pool, expected);
}

Image decodeImage(std::string_view bytes, const fs::path& name, ImagePool& pool, std::optional<ImageSize> expected) {
  const ImageCodec& codec = requiredCodecOf(bytes, name);
  const ImageSize size = codec.size(bytes, name);
  if (expected && size != *expected)
    throw InputError(name.string() + ": has " + size.text() + " pixels, the sequence has " + expected->text());
  return codec.decode(bytes, name, pool);
}

}  // namespace motorcade
