#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <jpeglib.h>

#include "io/files/errors.hpp"
#include "io/images/image_file.hpp"
#include "tests/io/images/image_samples.hpp"
#include "tests/io/images/png_sample.hpp"
#include "tests/io/temporary_folder.hpp"

/// The kinds of images within a format, and files of other formats: read, or named with what converts them.
namespace motorcade {
namespace {

using test::jpegOf;
using test::messageOf;
using test::noise;
using test::Scans;
using testing::AllOf;
using testing::HasSubstr;

/// Four channels of ink, as printers' programs write them.
std::string inkJpegOf(int width, int height, J_COLOR_SPACE space) {
  jpeg_compress_struct jpeg{};
  jpeg_error_mgr errors;
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &bytes, &size);
  jpeg.image_width = static_cast<JDIMENSION>(width);
  jpeg.image_height = static_cast<JDIMENSION>(height);
  jpeg.input_components = 4;
  jpeg.in_color_space = JCS_CMYK;
  jpeg_set_defaults(&jpeg);
  jpeg_set_colorspace(&jpeg, space);
  jpeg_start_compress(&jpeg, TRUE);
  std::vector<std::uint8_t> row(4 * static_cast<std::size_t>(width), 90);
  for (int y = 0; y < height; ++y) {
    JSAMPROW start = row.data();
    jpeg_write_scanlines(&jpeg, &start, 1);
  }
  jpeg_finish_compress(&jpeg);
  std::string result(reinterpret_cast<char*>(bytes), size);
  jpeg_destroy_compress(&jpeg);
  std::free(bytes);
  return result;
}

/// The same file with another first byte after the mark of its frame, or another mark.
std::string withFrame(std::string jpeg, char mark, char bits) {
  const auto frame = jpeg.find("\xFF\xC0");
  jpeg[frame + 1] = mark;
  jpeg[frame + 4] = bits;
  return jpeg;
}

class ImageKinds : public testing::Test {
 protected:
  test::TemporaryFolder folder_;
  ImagePool pool_;
};

TEST_F(ImageKinds, SamplesOfFewerBitsAreScaledAlikeInGrayAndInColors) {
  const std::string gray = test::PngSample{.bits = 16}.write(),
                    colors = test::PngSample{.color = PNG_COLOR_TYPE_RGB, .bits = 16}.write();
  const auto deep = readPng16(folder_.write("gray.png", gray));
  const Image twelve = decodeImage(gray, "gray.png", pool_, {.sample_bits = 12});
  for (int i = 0; i < 61 * 37; ++i)
    ASSERT_EQ(twelve.at(i % 61, i / 61), std::min(deep.pixels[static_cast<std::size_t>(i)] >> 4, 255));
  EXPECT_EQ(readBrightestSample(folder_ / "gray.png"), std::ranges::max(deep.pixels));
  EXPECT_EQ(readImageHeader(folder_ / "gray.png"), (ImageHeader{.size = {61, 37}, .channels = 1, .bits = 16}));
  EXPECT_EQ(readImageHeader(folder_.write("colors.png", colors)).channels, 3);
  const Image of_colors = decodeImage(colors, "colors.png", pool_, {.sample_bits = 16});
  EXPECT_GT(decodeImage(colors, "colors.png", pool_, {.sample_bits = 14}).at(1, 1), of_colors.at(1, 1));
}

TEST_F(ImageKinds, BitsInUseAreThoseOfCamerasAndOfTheFile) {
  for (const auto& [brightest, bits] : {std::pair(0, 8),
                                        {255, 8},
                                        {256, 10},
                                        {1023, 10},
                                        {1024, 12},
                                        {4095, 12},
                                        {4096, 14},
                                        {16383, 14},
                                        {16384, 16},
                                        {65535, 16}})
    EXPECT_EQ(usedSampleBits(0, brightest), bits) << brightest;
  EXPECT_EQ(usedSampleBits(11, 300), 11);
  EXPECT_EQ(usedSampleBits(11, 2048), 16) << "scaled up by the file";
  EXPECT_EQ(usedSampleBits(16, 1020), 10) << "what the format has, not what the camera has";
  EXPECT_EQ(upperBits(1023, 10), 255);
  EXPECT_EQ(upperBits(1024, 10), 255);
  EXPECT_EQ(upperBits(515, 10), 128);
}

TEST_F(ImageKinds, PpmIsReadAsItsLuma) {
  std::string binary = "P6 16 16 255\n", ascii = "P3\n16 16\n1023\n";
  for (int i = 0; i < 256; ++i) {
    binary += {static_cast<char>(200), static_cast<char>(i), 30};
    ascii += "800 " + std::to_string(4 * i) + " 120\n";
  }
  for (const auto& file : {folder_.write("a.ppm", binary), folder_.write("b.ppm", ascii)}) {
    EXPECT_TRUE(hasImageName(file));
    EXPECT_EQ(readImageHeader(file).channels, 3);
    const Image image = readImage(file, pool_);
    for (int i = 0; i < 256; ++i) ASSERT_NEAR(image.at(i % 16, i / 16), grayOf(200, i, 30), 1) << file;
  }
}

TEST_F(ImageKinds, KindsOfJpegThatAreNotReadAreNamedWithWhatConvertsThem) {
  const std::string gray = jpegOf(noise(32, 32, pool_));
  const std::vector<std::pair<std::string, std::string>> kinds{{inkJpegOf(32, 32, JCS_CMYK), "color space CMYK"},
                                                               {inkJpegOf(32, 32, JCS_YCCK), "color space YCCK"},
                                                               {withFrame(gray, '\xC0', 12), "12 bits"},
                                                               {withFrame(gray, '\xC3', 8), "lossless"},
                                                               {withFrame(gray, '\xF7', 8), "JPEG-LS"}};
  for (const auto& [bytes, kind] : kinds) {
    const auto file = folder_.write("a drive/left/a.jpg", bytes);
    for (const auto& message :
         {messageOf<InputError>([&] { readImageSize(file); }), messageOf<InputError>([&] { readImage(file, pool_); })})
      EXPECT_THAT(message,
                  AllOf(HasSubstr(file.string() + ": is "), HasSubstr(kind),
                        HasSubstr("mogrify -format jpg -colorspace Gray '" + file.parent_path().string() + "'/*.jpg")));
  }
}

TEST_F(ImageKinds, JpegsOfArithmeticCodingAreReadOrNamed) {
  const Image image = noise(32, 32, pool_);
  const auto file = folder_.write("a.jpg", jpegOf(image, Scans::kArithmetic));
  try {
    EXPECT_NEAR(readImage(file, pool_).at(3, 4), image.at(3, 4), 4);
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("arithmetic"));
  }
}

TEST_F(ImageKinds, KindsOfPngAreAllRead) {
  for (const auto& [color, bits] : {std::pair(PNG_COLOR_TYPE_GRAY, 1),
                                    {PNG_COLOR_TYPE_GRAY, 2},
                                    {PNG_COLOR_TYPE_GRAY, 4},
                                    {PNG_COLOR_TYPE_GRAY, 16},
                                    {PNG_COLOR_TYPE_GRAY_ALPHA, 8},
                                    {PNG_COLOR_TYPE_GRAY_ALPHA, 16},
                                    {PNG_COLOR_TYPE_PALETTE, 8},
                                    {PNG_COLOR_TYPE_RGB, 16},
                                    {PNG_COLOR_TYPE_RGB_ALPHA, 8},
                                    {PNG_COLOR_TYPE_RGB_ALPHA, 16}})
    for (const int interlace : {PNG_INTERLACE_NONE, PNG_INTERLACE_ADAM7})
      EXPECT_NO_THROW(
          decodeImage(test::PngSample{.color = color, .bits = bits, .interlace = interlace}.write(), "a.png", pool_))
          << "color " << color << ", " << bits << " bits, interlace " << interlace;
}

TEST_F(ImageKinds, OtherFilesAreNamedByTheirContent) {
  using std::literals::string_literals::operator""s;
  const std::vector<std::pair<std::string, std::string>> files{
      {"II*\0\x08\0\0\0"s, "TIFF"},
      {"MM\0*\0\0\0\x08"s, "TIFF"},
      {"RIFF\x10\0\0\0WEBPVP8 "s, "WebP"},
      {"RIFF\x10\0\0\0AVI LIST"s, "ffmpeg -i"},
      {"BM\x36\0\0\0"s, "BMP"},
      {"GIF89a"s, "GIF"},
      {"\0\0\0\x0cjP  \r\n\x87\n"s, "JPEG 2000"},
      {"\xFF\x0A\x00\x10"s, "JPEG XL"},
      {"\0\0\0\x20"
       "ftypavif"s,
       "AVIF"},
      {"\0\0\0\x20"
       "ftypheic"s,
       "HEIF"},
      {"\0\0\0\x20"
       "ftypisom"s,
       "MP4"},
      {"P4\n16 16\n"s, "PBM"},
      {"P7\nWIDTH 16\n"s, "PAM"},
      {"Pf\n16 16\n-1\n"s, "PFM"},
      {"\x93NUMPY\x01\0"s, "numpy"},
      {"version https://git-lfs.github.com/spec/v1\n"s, "git lfs pull"},
      {"<!DOCTYPE html>\n"s, "web page"},
      {"\x1F\x8B\x08"s, "gzip"},
      {std::string(64, '\x07'), "raw dump"},
      {"", "the file is empty"}};
  for (const auto& [bytes, name] : files) {
    const auto file = folder_.write("it's/a.png", bytes);
    EXPECT_THAT(messageOf<InputError>([&] { readImage(file, pool_); }),
                AllOf(HasSubstr("a.png: is "), HasSubstr(name)));
    EXPECT_EQ(imageFormat(file), ImageFormat::kUnknown) << name;
  }
  const auto tiff = folder_.write("it's/a.tif", "II*\0\x08\0\0\0"s);
  EXPECT_THAT(messageOf<InputError>([&] { readImage(tiff, pool_); }),
              HasSubstr("Gray '" + folder_.path().string() + "/it'\\''s'/*.tif"));
}

}  // namespace
}  // namespace motorcade
