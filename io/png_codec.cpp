#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdint>
#include <new>

#include <png.h>

#include "io/errors.hpp"
#include "io/image_codec.hpp"
#include "io/png_chunks.hpp"
#include "io/png_context.hpp"
#include "io/png_fast_decoder.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

bool isPng(std::string_view bytes) { return bytes.starts_with(kPngSignature); }

/// BT.601 in 8-bit integers.
std::uint8_t grayOfPixel(const std::uint8_t* rgb) { return grayOf(rgb[0], rgb[1], rgb[2]); }

ImageSize pngSize(std::string_view bytes, const fs::path& file) {
  if (bytes.size() < 26 || bytes.substr(12, 4) != "IHDR") failDamaged(file, "its PNG header is cut");
  return checkedSize(bigEndian32(bytes, 16), bigEndian32(bytes, 20), file);
}

/// The size of an image whose pixels may be in the file: deflate packs at most 1032 bytes into one.
ImageSize decodableSize(std::string_view bytes, const fs::path& file) {
  constexpr std::uint64_t kMostPerByte = 1032, kBitsPerByte = 8;
  const ImageSize size = pngSize(bytes, file);
  const auto bits_per_sample = static_cast<std::uint8_t>(bytes[24]);
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

Image decodePng(std::string_view bytes, const fs::path& file, ImagePool& pool) {
  if (auto image = decodeCommonPng(bytes, decodableSize(bytes, file), pool)) return *std::move(image);
  return decodeAnyPng(bytes, file, pool);
}

}  // namespace

Image decodeAnyPng(std::string_view bytes, const fs::path& file, ImagePool& pool) {
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
  static constexpr ImageCodec kCodec{ImageFormat::kPng, isPng, pngSize, decodePng};
  return kCodec;
}

Gray16Image readPng16(const fs::path& file) {
  const std::string bytes = readImageBytes(file);
  if (!isPng(bytes)) throw InputError(file.string() + ": is no PNG");
  const ImageSize size = decodableSize(bytes, file);
  PngReader reader(bytes);
  if (!reader.readHeader(true)) failDamaged(file, reader.context.message.data());
  if (png_get_channels(reader.png, reader.info) != 1)
    throw InputError(file.string() + ": has colors, a gray image is needed");
  Gray16Image image{size.width, size.height, {}};
  image.pixels.resize(size.width * size.height);
  const bool wide = png_get_bit_depth(reader.png, reader.info) == 16;
  std::vector<std::uint8_t> narrow(wide ? 0 : image.pixels.size());
  const std::size_t row_values = size.width;
  auto rows = wide ? rowPointers(reinterpret_cast<std::uint8_t*>(image.pixels.data()), size.height, 2 * row_values)
                   : rowPointers(narrow.data(), size.height, row_values);
  if (!reader.readRows(rows.data())) failDamaged(file, reader.context.message.data());
  if (!wide) std::ranges::copy(narrow, image.pixels.begin());
  return image;
}

}  // namespace motorcade
