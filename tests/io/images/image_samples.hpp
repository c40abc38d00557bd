#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

#include <gtest/gtest.h>
#include <jpeglib.h>

#include "core/image.hpp"

/// Images and files of them for tests of the codecs.
namespace motorcade::test {

inline Image noise(int width, int height, ImagePool& pool) {
  std::mt19937 random(3);
  Image image = pool.acquire(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.mutableRow(y)[x] = static_cast<std::uint8_t>(random());
  return image;
}

inline void expectEqual(const Image& a, const Image& b) {
  ASSERT_EQ(a.width(), b.width());
  ASSERT_EQ(a.height(), b.height());
  for (int y = 0; y < a.height(); ++y) ASSERT_TRUE(std::equal(a.row(y), a.row(y) + a.width(), b.row(y))) << "row " << y;
}

enum class Scans { kBaseline, kProgressive, kArithmetic };

inline std::string jpegOf(const Image& image, Scans scans = Scans::kBaseline) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors;
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &bytes, &size);
  jpeg.image_width = static_cast<JDIMENSION>(image.width());
  jpeg.image_height = static_cast<JDIMENSION>(image.height());
  jpeg.input_components = 1;
  jpeg.in_color_space = JCS_GRAYSCALE;
  jpeg_set_defaults(&jpeg);
  jpeg_set_quality(&jpeg, 100, TRUE);
  if (scans == Scans::kProgressive) jpeg_simple_progression(&jpeg);
  jpeg.arith_code = scans == Scans::kArithmetic ? TRUE : FALSE;
  jpeg_start_compress(&jpeg, TRUE);
  for (int y = 0; y < image.height(); ++y) {
    JSAMPROW row = const_cast<JSAMPROW>(image.row(y));
    jpeg_write_scanlines(&jpeg, &row, 1);
  }
  jpeg_finish_compress(&jpeg);
  std::string result(reinterpret_cast<char*>(bytes), size);
  jpeg_destroy_compress(&jpeg);
  std::free(bytes);
  return result;
}

}  // namespace motorcade::test
