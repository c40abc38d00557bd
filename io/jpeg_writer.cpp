#include <cstdio>
#include <cstdlib>
#include <memory>

#include <jpeglib.h>

#include "io/image_file.hpp"

namespace motorcade {

std::string encodeJpeg(const Image& image, int quality) {
  jpeg_error_mgr errors{};
  jpeg_compress_struct jpeg{};
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  const std::unique_ptr<jpeg_compress_struct, void (*)(jpeg_compress_struct*)> destroyed(&jpeg, jpeg_destroy_compress);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &bytes, &size);
  jpeg.image_width = static_cast<JDIMENSION>(image.width());
  jpeg.image_height = static_cast<JDIMENSION>(image.height());
  jpeg.input_components = 1;
  jpeg.in_color_space = JCS_GRAYSCALE;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, quality, TRUE);
  jpeg_start_compress(&jpeg, TRUE);
  for (int y = 0; y < image.height(); ++y) {
    JSAMPROW row = const_cast<JSAMPROW>(image.row(y));  // libjpeg does not write to it
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  const std::unique_ptr<unsigned char, void (*)(void*)> freed(bytes, std::free);
  return {reinterpret_cast<const char*>(bytes), size};
}

}  // namespace motorcade
