#include <cstdio>
#include <cstdlib>
#include <memory>

#include <jpeglib.h>

#include "io/images/image_file.hpp"

namespace motorcade {
namespace {

/// Image properties that libjpeg needs; the pixels come from `row_at`.
struct Rows {
  int width = 0, height = 0, components = 1;
  J_COLOR_SPACE colors = JCS_GRAYSCALE;
};

template <class RowAt>
std::string encode(const Rows& rows, int quality, const RowAt& row_at) {
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
  jpeg.in_color_space = rows.colors;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, quality, TRUE);
  jpeg_start_compress(&jpeg, TRUE);
  for (int y = 0; y < rows.height; ++y) {
    JSAMPROW row = const_cast<JSAMPROW>(row_at(y));  // libjpeg does not write to it
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  const std::unique_ptr<unsigned char, void (*)(void*)> freed(bytes, std::free);
  return {reinterpret_cast<const char*>(bytes), size};
}

}  // namespace

std::string encodeJpeg(const Image& image, int quality) {
  return encode({.width = image.width(), .height = image.height()}, quality, [&](int y) { return image.row(y); });
}

std::string encodeJpeg(const RgbImage& image, int quality) {
  return encode({image.width, image.height, 3, JCS_RGB}, quality, [&](int y) { return image.at(0, y); });
}

}  // namespace motorcade
