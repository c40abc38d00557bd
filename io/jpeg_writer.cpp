#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include <jpeglib.h>

#include "io/image_file.hpp"

namespace motorcade {

namespace {

/// Rows of gray or color pixels as libjpeg takes them.
struct Rows {
  const std::uint8_t* first;
  int width, height;
  std::ptrdiff_t stride;
  int components;
};

std::string encoded(const Rows& rows, int quality) {
  jpeg_error_mgr errors{};
  jpeg_compress_struct jpeg{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  const std::unique_ptr<jpeg_compress_struct, void (*)(jpeg_compress_struct*)> destroyed(&jpeg, jpeg_destroy_compress);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &bytes, &size);
  jpeg.image_width = static_cast<JDIMENSION>(rows.width);
  jpeg.image_height = static_cast<JDIMENSION>(rows.height);
  jpeg.input_components = rows.components;
  jpeg.in_color_space = rows.components == 1 ? JCS_GRAYSCALE : JCS_RGB;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, quality, TRUE);
  jpeg_start_compress(&jpeg, TRUE);
  for (int y = 0; y < rows.height; ++y) {
    JSAMPROW row = const_cast<JSAMPROW>(rows.first + y * rows.stride);  // libjpeg does not write to it
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  const std::unique_ptr<unsigned char, void (*)(void*)> freed(bytes, std::free);
  return {reinterpret_cast<const char*>(bytes), size};
}

}  // namespace

std::string encodeJpeg(const Image& image, int quality) {
  return encoded({image.data(), image.width(), image.height(), image.stride(), 1}, quality);
}

std::string encodeJpeg(const RgbImage& image, int quality) {
  constexpr int kColors = 3;
  return encoded({image.pixels.data(), image.width, image.height, std::ptrdiff_t{kColors} * image.width, kColors},
                 quality);
}

}  // namespace motorcade
