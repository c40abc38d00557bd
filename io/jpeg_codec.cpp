#include <array>
#include <csetjmp>
#include <cstdio>

#include <jpeglib.h>

#include "io/image_codec.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

bool isJpeg(std::string_view bytes) { return bytes.starts_with("\xFF\xD8\xFF"); }

/// A progressive file refines the whole image in each scan. Encoders make ten or so; a file of a few kB that tells of
/// thousands would take hours.
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
  /// Libjpeg would fill a cut file up with gray.
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
  /// Libjpeg may have warned of what is wrong with the header.
  bool damaged() const { return errors.manager.num_warnings > 0; }
};

ImageSize jpegSize(std::string_view bytes, const fs::path& file) {
  JpegReader reader;
  if (!reader.readHeader(bytes)) failDamaged(file, reader.errors.message.data());
  return checkedSize(reader.jpeg.image_width, reader.jpeg.image_height, file);
}

Image decodeJpeg(std::string_view bytes, const fs::path& file, ImagePool& pool) {
  JpegReader reader;
  if (!reader.readHeader(bytes)) failDamaged(file, reader.errors.message.data());
  const ImageSize size = checkedSize(reader.jpeg.image_width, reader.jpeg.image_height, file);
  Image image = pool.acquire(size.width, size.height);
  auto rows = rowPointers(image.mutableRow(0), size.height, image.stride());
  if (!reader.readRows(rows.data())) failDamaged(file, reader.errors.message.data());
  if (reader.damaged()) failDamaged(file, "its JPEG data are cut or broken");
  return image;
}

}  // namespace

const ImageCodec& jpegCodec() {
  static constexpr ImageCodec kCodec{ImageFormat::kJpeg, isJpeg, jpegSize, decodeJpeg};
  return kCodec;
}

}  // namespace motorcade
