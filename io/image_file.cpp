#include "io/image_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <optional>

#include <jpeglib.h>
#include <png.h>

#include "io/errors.hpp"
#include "io/text_file.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

constexpr int kMinSide_px = 16, kMaxSide_px = 16384;
constexpr std::size_t kMaxFile_bytes = std::size_t{1} << 28;

/// BT.601 in 8-bit integers.
std::uint8_t grayOf(const std::uint8_t* rgb) {
  return static_cast<std::uint8_t>((77 * rgb[0] + 150 * rgb[1] + 29 * rgb[2] + 128) >> 8);
}

ImageFormat formatOf(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG\r\n\x1a\n")) return ImageFormat::kPng;
  if (bytes.starts_with("\xFF\xD8\xFF")) return ImageFormat::kJpeg;
  if (bytes.starts_with("P5") || bytes.starts_with("P2")) return ImageFormat::kPgm;
  return ImageFormat::kUnknown;
}

ImageSize checkedSize(std::uint64_t width, std::uint64_t height, const fs::path& file) {
  const auto bad = [](std::uint64_t side) { return side < kMinSide_px || side > kMaxSide_px; };
  if (bad(width) || bad(height)) {
    throw InputError(file.string() + ": its header tells " + std::to_string(width) + "x" + std::to_string(height) +
                     " pixels; each side must lie between " + std::to_string(kMinSide_px) + " and " +
                     std::to_string(kMaxSide_px));
  }
  return {static_cast<int>(width), static_cast<int>(height)};
}

[[noreturn]] void failDamaged(const fs::path& file, const std::string& why) {
  throw InputError(file.string() + ": damaged image: " + why);
}

// ---- PNG ----

std::uint64_t bigEndian32(std::string_view bytes, std::size_t at) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<std::uint8_t>(bytes[at + i]);
  return value;
}

ImageSize pngSize(std::string_view bytes, const fs::path& file) {
  if (bytes.size() < 26 || bytes.substr(12, 4) != "IHDR") failDamaged(file, "its PNG header is cut");
  return checkedSize(bigEndian32(bytes, 16), bigEndian32(bytes, 20), file);
}

/// What libpng's callbacks need. libpng reports errors by jumping: no function between `setjmp` and the jump owns
/// anything.
struct PngContext {
  std::string_view bytes;
  std::array<char, 128> message{};

  static void read(png_structp png, png_bytep to, std::size_t count) {
    auto& context = *static_cast<PngContext*>(png_get_io_ptr(png));
    if (context.bytes.size() < count) png_error(png, "the file ends early");
    std::memcpy(to, context.bytes.data(), count);
    context.bytes.remove_prefix(count);
  }
  [[noreturn]] static void fail(png_structp png, png_const_charp text) {
    auto& context = *static_cast<PngContext*>(png_get_error_ptr(png));
    std::strncpy(context.message.data(), text, context.message.size() - 1);
    png_longjmp(png, 1);
  }
  static void warn(png_structp, png_const_charp) {}
};

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

std::vector<png_bytep> rowPointers(std::uint8_t* first, int height, std::size_t stride) {
  std::vector<png_bytep> rows(static_cast<std::size_t>(height));
  for (std::size_t y = 0; y < rows.size(); ++y) rows[y] = first + y * stride;
  return rows;
}

Image decodePng(std::string_view bytes, const fs::path& file, ImagePool& pool) {
  const ImageSize size = pngSize(bytes, file);
  PngReader reader(bytes);
  if (!reader.readHeader(false)) failDamaged(file, reader.context.message.data());
  Image image = pool.acquire(size.width, size.height);
  const std::size_t row_bytes = png_get_rowbytes(reader.png, reader.info);
  const bool gray = png_get_channels(reader.png, reader.info) == 1;
  std::vector<std::uint8_t> colors(gray ? 0 : row_bytes * static_cast<std::size_t>(size.height));
  auto rows = gray ? rowPointers(image.mutableRow(0), size.height, static_cast<std::size_t>(image.stride()))
                   : rowPointers(colors.data(), size.height, row_bytes);
  if (!reader.readRows(rows.data())) failDamaged(file, reader.context.message.data());
  for (int y = 0; !gray && y < size.height; ++y) {
    const std::uint8_t* rgb = rows[y];
    for (int x = 0; x < size.width; ++x) image.mutableRow(y)[x] = grayOf(rgb + 3 * x);
  }
  return image;
}

// ---- JPEG ----

struct JpegErrors {
  jpeg_error_mgr manager;
  std::jmp_buf jump;
  std::array<char, JMSG_LENGTH_MAX> message;

  [[noreturn]] static void fail(j_common_ptr jpeg) {
    auto& errors = *reinterpret_cast<JpegErrors*>(jpeg->err);
    errors.manager.format_message(jpeg, errors.message.data());
    std::longjmp(errors.jump, 1);
  }
  static void ignore(j_common_ptr) {}
};

struct JpegReader {
  JpegErrors errors{};
  jpeg_decompress_struct jpeg{};

  JpegReader() {
    jpeg.err = jpeg_std_error(&errors.manager);
    errors.manager.error_exit = JpegErrors::fail;
    errors.manager.output_message = JpegErrors::ignore;
  }
  ~JpegReader() { jpeg_destroy_decompress(&jpeg); }
  JpegReader(const JpegReader&) = delete;
  JpegReader& operator=(const JpegReader&) = delete;

  bool readHeader(std::string_view bytes) {
    if (setjmp(errors.jump)) return false;
    jpeg_create_decompress(&jpeg);
    jpeg_mem_src(&jpeg, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
    jpeg_read_header(&jpeg, TRUE);
    jpeg.out_color_space = JCS_GRAYSCALE;  // of a color file: its luma, which is BT.601
    return true;
  }
  bool readRows(JSAMPARRAY rows) {
    if (setjmp(errors.jump)) return false;
    jpeg_start_decompress(&jpeg);
    while (jpeg.output_scanline < jpeg.output_height)
      jpeg_read_scanlines(&jpeg, rows + jpeg.output_scanline, jpeg.output_height - jpeg.output_scanline);
    jpeg_finish_decompress(&jpeg);
    return true;
  }
  /// libjpeg fills a cut file up with gray and only warns.
  bool damaged() const { return errors.manager.num_warnings > 0; }
};

Image decodeJpeg(std::string_view bytes, const fs::path& file, ImagePool& pool) {
  JpegReader reader;
  if (!reader.readHeader(bytes)) failDamaged(file, reader.errors.message.data());
  const ImageSize size = checkedSize(reader.jpeg.image_width, reader.jpeg.image_height, file);
  Image image = pool.acquire(size.width, size.height);
  auto rows = rowPointers(image.mutableRow(0), size.height, static_cast<std::size_t>(image.stride()));
  if (!reader.readRows(rows.data())) failDamaged(file, reader.errors.message.data());
  if (reader.damaged()) failDamaged(file, "its JPEG data are cut or broken");
  return image;
}

// ---- PGM ----

struct PgmHeader {
  ImageSize size;
  int max_value = 0;
  std::size_t data_at = 0;
  bool binary = true;
};

/// The next number of a PGM header or of ASCII data; '#' starts a comment.
std::optional<int> pgmNumber(std::string_view bytes, std::size_t& at) {
  while (at < bytes.size() && (std::isspace(static_cast<unsigned char>(bytes[at])) || bytes[at] == '#')) {
    if (bytes[at] == '#') at = std::min(bytes.find('\n', at), bytes.size() - 1);
    ++at;
  }
  int value = 0, digits = 0;
  for (; at < bytes.size() && std::isdigit(static_cast<unsigned char>(bytes[at])) && digits < 9; ++at, ++digits)
    value = value * 10 + (bytes[at] - '0');
  return digits > 0 ? std::optional(value) : std::nullopt;
}

PgmHeader pgmHeader(std::string_view bytes, const fs::path& file) {
  std::size_t at = 2;
  const auto width = pgmNumber(bytes, at), height = pgmNumber(bytes, at), max_value = pgmNumber(bytes, at);
  if (!width || !height || !max_value || *max_value < 1 || *max_value > 65535)
    failDamaged(file, "its PGM header is cut or wrong");
  return {checkedSize(static_cast<std::uint64_t>(*width), static_cast<std::uint64_t>(*height), file), *max_value,
          at + 1, bytes[1] == '5'};
}

Image decodePgm(std::string_view bytes, const fs::path& file, ImagePool& pool) {
  const PgmHeader header = pgmHeader(bytes, file);
  const std::size_t sample_bytes = header.max_value > 255 ? 2 : 1;
  const auto pixels = static_cast<std::size_t>(header.size.width) * static_cast<std::size_t>(header.size.height);
  if (header.binary && bytes.size() < header.data_at + pixels * sample_bytes) failDamaged(file, "the file ends early");
  Image image = pool.acquire(header.size.width, header.size.height);
  std::size_t at = header.data_at;
  for (int y = 0; y < header.size.height; ++y) {
    if (header.binary && header.max_value == 255) {
      std::memcpy(image.mutableRow(y), bytes.data() + at, static_cast<std::size_t>(header.size.width));
      at += static_cast<std::size_t>(header.size.width);
      continue;
    }
    for (int x = 0; x < header.size.width; ++x) {
      int value = 0;
      if (header.binary) {
        for (std::size_t i = 0; i < sample_bytes; ++i) value = value << 8 | static_cast<std::uint8_t>(bytes[at++]);
      } else {
        const auto number = pgmNumber(bytes, at);
        if (!number) failDamaged(file, "the file ends early");
        value = *number;
      }
      image.mutableRow(y)[x] = static_cast<std::uint8_t>(std::min(value, header.max_value) * 255 / header.max_value);
    }
  }
  return image;
}

// ---- writing ----

/// Owns the file and libpng's writer; an unfinished file is removed.
struct PngWriter {
  fs::path file;
  PngContext context;
  std::FILE* out = nullptr;
  png_structp png = nullptr;
  png_infop info = nullptr;

  explicit PngWriter(const fs::path& path) : file(path) {
    out = std::fopen(path.c_str(), "wb");
    if (!out) throw OutputError(path.string() + ": cannot be created: " + std::strerror(errno));
    png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &context, PngContext::fail, PngContext::warn);
    if (png) info = png_create_info_struct(png);
    if (info) return;
    release();
    throw std::bad_alloc();
  }
  ~PngWriter() { release(); }
  PngWriter(const PngWriter&) = delete;
  PngWriter& operator=(const PngWriter&) = delete;

  bool write(ImageSize size, int bits, int color, PngEffort effort, png_bytepp rows) {
    if (setjmp(png_jmpbuf(png))) return false;
    png_init_io(png, out);
    // Level 1 with the "up" filter: three times as fast as the defaults, a tenth larger on noisy images.
    png_set_compression_level(png, effort == PngEffort::kFast ? 1 : 6);
    if (effort == PngEffort::kFast) png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP);
    png_set_IHDR(png, info, static_cast<png_uint_32>(size.width), static_cast<png_uint_32>(size.height), bits, color,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    if (bits == 16) png_set_swap(png);
    png_write_image(png, rows);
    png_write_end(png, nullptr);
    return true;
  }
  bool close() {
    const bool good = std::fclose(out) == 0;
    out = nullptr;
    return good;
  }
  void release() {
    png_destroy_write_struct(&png, &info);
    if (out) std::fclose(out);
    out = nullptr;
  }
};

void writeRows(const fs::path& file, ImageSize size, int bits, int color, PngEffort effort,
               std::vector<png_bytep> rows) {
  PngWriter writer(file);
  if (!writer.write(size, bits, color, effort, rows.data()) || !writer.close()) {
    const std::string why = errno != 0 ? std::strerror(errno) : writer.context.message.data();
    writer.release();
    std::error_code ignored;
    if (fs::is_regular_file(file, ignored)) fs::remove(file, ignored);
    throw OutputError(file.string() + ": cannot be written: " + why);
  }
}

/// libpng asks for writable rows and does not write to them.
std::uint8_t* forLibpng(const void* pixels) { return static_cast<std::uint8_t*>(const_cast<void*>(pixels)); }

}  // namespace

bool hasImageName(const fs::path& file) {
  std::string extension = file.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg" || extension == ".pgm";
}

ImageFormat imageFormat(const fs::path& file) {
  std::array<char, 8> start{};
  std::ifstream in(file, std::ios::binary);
  in.read(start.data(), start.size());
  return formatOf({start.data(), static_cast<std::size_t>(in.gcount())});
}

ImageSize readImageSize(const fs::path& file) {
  const std::string bytes = readWhole(file, kMaxFile_bytes);
  switch (formatOf(bytes)) {
    case ImageFormat::kPng:
      return pngSize(bytes, file);
    case ImageFormat::kPgm:
      return pgmHeader(bytes, file).size;
    case ImageFormat::kJpeg: {
      JpegReader reader;
      if (!reader.readHeader(bytes)) failDamaged(file, reader.errors.message.data());
      return checkedSize(reader.jpeg.image_width, reader.jpeg.image_height, file);
    }
    case ImageFormat::kUnknown:
      break;
  }
  throw InputError(file.string() + ": is neither PNG, JPEG nor PGM" + (bytes.empty() ? "; the file is empty" : ""));
}

Image readImage(const fs::path& file, ImagePool& pool) {
  const std::string bytes = readWhole(file, kMaxFile_bytes);
  switch (formatOf(bytes)) {
    case ImageFormat::kPng:
      return decodePng(bytes, file, pool);
    case ImageFormat::kJpeg:
      return decodeJpeg(bytes, file, pool);
    case ImageFormat::kPgm:
      return decodePgm(bytes, file, pool);
    case ImageFormat::kUnknown:
      break;
  }
  throw InputError(file.string() + ": is neither PNG, JPEG nor PGM" + (bytes.empty() ? "; the file is empty" : ""));
}

Gray16Image readPng16(const fs::path& file) {
  const std::string bytes = readWhole(file, kMaxFile_bytes);
  if (formatOf(bytes) != ImageFormat::kPng) throw InputError(file.string() + ": is no PNG");
  const ImageSize size = pngSize(bytes, file);
  PngReader reader(bytes);
  if (!reader.readHeader(true)) failDamaged(file, reader.context.message.data());
  if (png_get_channels(reader.png, reader.info) != 1)
    throw InputError(file.string() + ": has colors, a gray image is needed");
  Gray16Image image{size.width, size.height, {}};
  image.pixels.resize(static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height));
  const bool wide = png_get_bit_depth(reader.png, reader.info) == 16;
  std::vector<std::uint8_t> narrow(wide ? 0 : image.pixels.size());
  const auto row_values = static_cast<std::size_t>(size.width);
  auto rows = wide ? rowPointers(forLibpng(image.pixels.data()), size.height, 2 * row_values)
                   : rowPointers(narrow.data(), size.height, row_values);
  if (!reader.readRows(rows.data())) failDamaged(file, reader.context.message.data());
  if (!wide) std::ranges::copy(narrow, image.pixels.begin());
  return image;
}

void writePng(const fs::path& file, const Image& image, PngEffort effort) {
  writeRows(file, {image.width(), image.height()}, 8, PNG_COLOR_TYPE_GRAY, effort,
            rowPointers(forLibpng(image.data()), image.height(), static_cast<std::size_t>(image.stride())));
}

void writePng16(const fs::path& file, const Gray16Image& image, PngEffort effort) {
  writeRows(file, {image.width, image.height}, 16, PNG_COLOR_TYPE_GRAY, effort,
            rowPointers(forLibpng(image.pixels.data()), image.height, 2 * static_cast<std::size_t>(image.width)));
}

void writePngRgb(const fs::path& file, const RgbImage& image, PngEffort effort) {
  writeRows(file, {image.width, image.height}, 8, PNG_COLOR_TYPE_RGB, effort,
            rowPointers(forLibpng(image.pixels.data()), image.height, 3 * static_cast<std::size_t>(image.width)));
}

}  // namespace motorcade
