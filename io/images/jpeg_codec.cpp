#include <array>
#include <csetjmp>
#include <cstdio>

#include <jerror.h>
#include <jpeglib.h>

#include "io/images/image_codec.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

bool isJpeg(std::string_view bytes) { return bytes.starts_with("\xFF\xD8\xFF"); }

/// Most scans of a progressive file, each of which refines the whole image. Encoders make ten or so; a file of a few kB
/// that claims thousands would take hours.
constexpr int kMostScans = 100;
/// Coefficients of a progressive file of 2^26 pixels in three colors.
constexpr long kMostCoefficients_bytes = 400'000'000;

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
  /// Fails on a warning: libjpeg would fill a cut file up with gray.
  static void failOnWarning(j_common_ptr jpeg, int level) {
    if (level < 0) fail(jpeg);
  }
  static void failOnManyScans(j_common_ptr jpeg) {
    if (reinterpret_cast<j_decompress_ptr>(jpeg)->input_scan_number <= kMostScans) return;
    auto& errors = *reinterpret_cast<JpegErrors*>(jpeg->err);
    std::snprintf(errors.message.data(), errors.message.size(), "it has more than %d scans", kMostScans);
    std::longjmp(errors.jump, 1);
  }
};

struct JpegReader {
  JpegErrors errors{};
  jpeg_decompress_struct jpeg{};
  jpeg_progress_mgr progress{};

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
    errors.manager.emit_message = JpegErrors::failOnWarning;
    progress.progress_monitor = JpegErrors::failOnManyScans;
    jpeg.progress = &progress;
    jpeg.mem->max_memory_to_use = kMostCoefficients_bytes;
    jpeg_start_decompress(&jpeg);
    while (jpeg.output_scanline < jpeg.output_height)
      jpeg_read_scanlines(&jpeg, rows + jpeg.output_scanline, jpeg.output_height - jpeg.output_scanline);
    jpeg_finish_decompress(&jpeg);
    return true;
  }
  /// Names the kind of JPEG that libjpeg does not decode; null for other errors.
  const char* unsupportedKind() const {
    switch (errors.manager.msg_code) {
      case JERR_BAD_PRECISION:
        return "a JPEG of 12 bits";
      case JERR_ARITH_NOTIMPL:
        return "a JPEG with arithmetic coding";
      case JERR_SOF_UNSUPPORTED:
        return "a lossless or hierarchical JPEG";
      case JERR_UNKNOWN_MARKER:
        return "a JPEG-LS image or another kind of JPEG";
      default:
        return nullptr;
    }
  }
  /// True after a warning. Libjpeg may have warned of a fault in the header.
  bool damaged() const { return errors.manager.num_warnings > 0; }
};

/// Null for gray and colors of light.
const char* unsupportedSpaceOf(J_COLOR_SPACE space) {
  switch (space) {
    case JCS_CMYK:
      return "a JPEG in the color space CMYK, of inks";
    case JCS_YCCK:
      return "a JPEG in the color space YCCK, CMYK of inks";
    case JCS_UNKNOWN:
      return "a JPEG in no known color space";
    default:
      return nullptr;
  }
}

void requireHeader(JpegReader& reader, std::string_view bytes, const fs::path& file) {
  if (reader.readHeader(bytes)) {
    if (const char* const space = unsupportedSpaceOf(reader.jpeg.jpeg_color_space)) failUnsupported(file, space);
    return;
  }
  if (const char* const kind = reader.unsupportedKind()) failUnsupported(file, kind);
  failDamaged(file, reader.errors.message.data());
}

ImageHeader jpegHeader(std::string_view bytes, const fs::path& file) {
  JpegReader reader;
  requireHeader(reader, bytes, file);
  return {.size = checkedSize(reader.jpeg.image_width, reader.jpeg.image_height, file),
          .channels = reader.jpeg.num_components == 1 ? 1 : 3};
}

Image decodeJpeg(std::string_view bytes, const fs::path& file, ImagePool& pool, int /*sample_bits*/) {
  JpegReader reader;
  requireHeader(reader, bytes, file);
  const ImageSize size = checkedSize(reader.jpeg.image_width, reader.jpeg.image_height, file);
  Image image = pool.acquire(size.width, size.height);
  auto rows = rowPointers(image.mutableRow(0), size.height, image.stride());
  if (!reader.readRows(rows.data())) failDamaged(file, reader.errors.message.data());
  if (reader.damaged()) failDamaged(file, "its JPEG data are cut or broken");
  return image;
}

}  // namespace

const ImageCodec& jpegCodec() {
  static constexpr ImageCodec kCodec{ImageFormat::kJpeg, isJpeg, jpegHeader, decodeJpeg, nullptr};
  return kCodec;
}

}  // namespace motorcade
