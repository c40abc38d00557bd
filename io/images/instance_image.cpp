#include <algorithm>
#include <array>
#include <csetjmp>
#include <cstdint>
#include <cstdio>
#include <new>
#include <string>
#include <vector>

#include "io/images/image_codec.hpp"
#include "io/images/mask_image.hpp"
#include "io/images/png_context.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

/// Owns libpng's reader of a PNG with a palette, so that a jump leaks nothing.
struct IndexReader {
  PngContext context;
  png_structp png = nullptr;
  png_infop info = nullptr;

  explicit IndexReader(std::string_view bytes) : context{.bytes = bytes} {
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &context, PngContext::fail, PngContext::warn);
    if (png) info = png_create_info_struct(png);
    if (!info) {
      png_destroy_read_struct(&png, nullptr, nullptr);
      throw std::bad_alloc();
    }
    png_set_read_fn(png, &context, PngContext::read);
  }
  ~IndexReader() { png_destroy_read_struct(&png, &info, nullptr); }
  IndexReader(const IndexReader&) = delete;
  IndexReader& operator=(const IndexReader&) = delete;

  /// Asks for one index in a byte.
  bool readHeader() {
    if (setjmp(png_jmpbuf(png))) return false;
    constexpr int kAllButTheImage = -1;
    png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, nullptr, kAllButTheImage);
    png_read_info(png, info);
    png_set_packing(png);
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

bool hasPalette(std::string_view bytes) {
  constexpr std::size_t kColorTypeAt = 25;
  return bytes.size() > kColorTypeAt && bytes[kColorTypeAt] == PNG_COLOR_TYPE_PALETTE;
}

}  // namespace

fs::path instanceFile(const fs::path& folder, FrameId frame) {
  fs::path rendered = maskFile(folder, frame);
  if (fs::exists(rendered)) return rendered;
  std::array<char, 48> name{};
  std::snprintf(name.data(), name.size(), "instancegt_%05lld.png", static_cast<long long>(frame.value));
  const fs::path virtual_kitti = folder / name.data();
  return fs::exists(virtual_kitti) ? virtual_kitti : rendered;
}

bool isInstanceFile(const fs::path& file) {
  const std::string name = file.filename().string();
  return isMaskFile(file) || (name.starts_with("instancegt_") && name.ends_with(".png"));
}

Gray16Image readInstances(const fs::path& file) {
  const std::string bytes = readImageBytes(file);
  if (!hasPalette(bytes)) return readPng16(file);
  const ImageSize size = readImageSize(file);
  IndexReader reader(bytes);
  if (!reader.readHeader()) failDamaged(file, reader.context.message.data());
  Gray16Image image{size.width, size.height, {}};
  std::vector<std::uint8_t> indices(static_cast<std::size_t>(size.width) * size.height);
  auto rows = rowPointers(indices.data(), size.height, static_cast<std::size_t>(size.width));
  if (!reader.readRows(rows.data())) failDamaged(file, reader.context.message.data());
  image.pixels.assign(indices.begin(), indices.end());
  return image;
}

}  // namespace motorcade
