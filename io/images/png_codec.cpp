#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdint>
#include <new>
#include <utility>
#include <vector>

#include <png.h>

#include "io/files/errors.hpp"
#include "io/images/image_codec.hpp"
#include "io/images/png_chunks.hpp"
#include "io/images/png_context.hpp"
#include "io/images/png_fast_decoder.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

bool isPng(std::string_view bytes) { return bytes.starts_with(kPngSignature); }

/// BT.601 in 8-bit integers.
std::uint8_t grayOfPixel(const std::uint8_t* rgb) { return grayOf(rgb[0], rgb[1], rgb[2]); }

constexpr std::size_t kBitsAt = 24, kColorAt = 25;  // in the file: the header comes first

/// The largest number of significant bits of a channel, from the sBIT chunk; 0 where none precedes the pixels.
int toldBits(std::string_view bytes, int channels) {
  bytes.remove_prefix(kPngSignature.size());
  for (auto chunk = takeChunk(bytes); chunk && chunk->name != "IDAT"; chunk = takeChunk(bytes)) {
    if (chunk->name == "sBIT" && std::cmp_greater_equal(chunk->data.size(), channels))
      return *std::ranges::max_element(chunk->data.substr(0, static_cast<std::size_t>(channels)));
  }
  return 0;
}

ImageHeader pngHeader(std::string_view bytes, const fs::path& file) {
  if (bytes.size() < kColorAt + 1 || bytes.substr(12, 4) != "IHDR") failDamaged(file, "its PNG header is cut");
  constexpr char kGray = 0, kGrayAlpha = 4;
  const char color = bytes[kColorAt];
  ImageHeader header{.size = checkedSize(bigEndian32(bytes, 16), bigEndian32(bytes, 20), file),
                     .channels = color == kGray || color == kGrayAlpha ? 1 : 3};
  if (bytes[kBitsAt] != kAllSampleBits) return header;
  header.bits = kAllSampleBits;
  header.told_bits = toldBits(bytes, header.channels);
  return header;
}

/// The size of an image, if the file is long enough for its pixels: deflate packs at most 1032 bytes into one.
ImageSize decodableSize(std::string_view bytes, const fs::path& file) {
  constexpr std::uint64_t kMostPerByte = 1032, kBitsPerByte = 8;
  const ImageSize size = pngHeader(bytes, file).size;
  const auto bits_per_sample = static_cast<std::uint8_t>(bytes[kBitsAt]);
  if (bytes.size() * kMostPerByte * kBitsPerByte < std::uint64_t{bits_per_sample} * size.width * size.height)
    failDamaged(file, "the file ends early");
  return size;
}

/// Owns libpng's reader, so that a jump leaks nothing.
struct PngReader {
  PngContext context;
  png_structp png = nullptr;
  png_infop info = nullptr;

  explicit PngReader(std::string_view bytes) : context{.bytes = bytes} {
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &context, PngContext::fail, PngContext::warn);
    if (png) info = png_create_info_struct(png);
    if (!info) {
      png_destroy_read_struct(&png, nullptr, nullptr);
      throw std::bad_alloc();
    }
    png_set_read_fn(png, &context, PngContext::read);
  }
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;

  /// Asks for gray or RGB without alpha, of 8 bits, or of 16 when the file has them and `keep_16` says so.
  bool readHeader(bool keep_16) {
    if (setjmp(png_jmpbuf(png))) return false;
    // Texts, profiles and the like are no part of the image, and could inflate to a thousand times 8 MB.
    constexpr int kAllButTheImage = -1;
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, nullptr, kAllButTheImage);
    png_read_info(png, info);
    png_set_expand(png);
    png_set_strip_alpha(png);
    if (keep_16) {
      png_set_swap(png);
    } else {
      png_set_strip_16(png);
    }
    png_set_interlace_handling(png);
    png_read_update_info(png, info);
    return true;
  }
  bool readRows(png_bytepp rows) {
    if (setjmp(png_jmpbuf(png))) return false;
    png_read_image(png, rows);
    png_read_end(png, nullptr);
    return true;
  }
};

/// Samples of 16 bits as they are, row by row; alpha is left out.
struct DeepSamples {
  ImageSize size;
  std::size_t channels = 1;
  std::vector<std::uint16_t> values;
};

DeepSamples deepSamplesOf(std::string_view bytes, const fs::path& file) {
  DeepSamples samples{.size = decodableSize(bytes, file), .values = {}};
  PngReader reader(bytes);
  if (!reader.readHeader(true)) failDamaged(file, reader.context.message.data());
  samples.channels = png_get_channels(reader.png, reader.info);
  const std::size_t row_values = samples.channels * samples.size.width;
  samples.values.resize(row_values * samples.size.height);
  auto rows = rowPointers(reinterpret_cast<std::uint8_t*>(samples.values.data()), samples.size.height, 2 * row_values);
  if (!reader.readRows(rows.data())) failDamaged(file, reader.context.message.data());
  return samples;
}

bool isDeep(std::string_view bytes) { return bytes.size() > kBitsAt && bytes[kBitsAt] == kAllSampleBits; }

Image grayOfDeep(const DeepSamples& samples, int sample_bits, ImagePool& pool) {
  Image image = pool.acquire(samples.size.width, samples.size.height);
  const std::uint16_t* at = samples.values.data();
  const auto upper = [sample_bits](std::uint16_t sample) { return upperBits(sample, sample_bits); };
  for (int y = 0; y < samples.size.height; ++y)
    for (int x = 0; x < samples.size.width; ++x, at += samples.channels)
      image.mutableRow(y)[x] = samples.channels == 1 ? upper(at[0]) : grayOf(upper(at[0]), upper(at[1]), upper(at[2]));
  return image;
}

int brightestOfPng(std::string_view bytes, const fs::path& file) {
  return std::ranges::max(deepSamplesOf(bytes, file).values);
}

Image decodePng(std::string_view bytes, const fs::path& file, ImagePool& pool, int sample_bits) {
  if (auto image = decodeCommonPng(bytes, decodableSize(bytes, file), pool, sample_bits)) return *std::move(image);
  return decodeAnyPng(bytes, file, pool, sample_bits);
}

}  // namespace

Image decodeAnyPng(std::string_view bytes, const fs::path& file, ImagePool& pool, int sample_bits) {
  if (sample_bits != kAllSampleBits && isDeep(bytes)) return grayOfDeep(deepSamplesOf(bytes, file), sample_bits, pool);
  const ImageSize size = decodableSize(bytes, file);
  PngReader reader(bytes);
  if (!reader.readHeader(false)) failDamaged(file, reader.context.message.data());
  Image image = pool.acquire(size.width, size.height);
  const std::size_t row_bytes = png_get_rowbytes(reader.png, reader.info);
  const bool gray = png_get_channels(reader.png, reader.info) == 1;
  std::vector<std::uint8_t> colors(gray ? 0 : row_bytes * size.height);
  auto rows = gray ? rowPointers(image.mutableRow(0), size.height, image.stride())
                   : rowPointers(colors.data(), size.height, row_bytes);
  if (!reader.readRows(rows.data())) failDamaged(file, reader.context.message.data());
  for (int y = 0; !gray && y < size.height; ++y) {
    const std::uint8_t* rgb = rows[y];
    for (int x = 0; x < size.width; ++x) image.mutableRow(y)[x] = grayOfPixel(rgb + 3 * x);
  }
  return image;
}

const ImageCodec& pngCodec() {
  static constexpr ImageCodec kCodec{ImageFormat::kPng, isPng, pngHeader, decodePng, brightestOfPng};
  return kCodec;
}

Gray16Image readPng16(const fs::path& file) {
  const std::string bytes = readImageBytes(file);
  if (!isPng(bytes)) throw InputError(file.string() + ": is no PNG");
  if (pngHeader(bytes, file).channels != 1) throw InputError(file.string() + ": has colors, a gray image is needed");
  if (isDeep(bytes)) {
    DeepSamples samples = deepSamplesOf(bytes, file);
    return {samples.size.width, samples.size.height, std::move(samples.values)};
  }
  ImagePool pool;
  const Image narrow = decodeAnyPng(bytes, file, pool);
  Gray16Image image{narrow.width(), narrow.height(), {}};
  image.pixels.reserve(static_cast<std::size_t>(narrow.width()) * narrow.height());
  for (int y = 0; y < narrow.height(); ++y)
    image.pixels.insert(image.pixels.end(), narrow.row(y), narrow.row(y) + narrow.width());
  return image;
}

}  // namespace motorcade
