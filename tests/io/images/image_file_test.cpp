#include "io/images/image_file.hpp"

#include <random>

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <zlib.h>

#include "io/files/errors.hpp"
#include "tests/io/images/image_samples.hpp"
#include "tests/io/images/png_sample.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using test::expectEqual;
using test::jpegOf;
using test::messageOf;
using test::noise;
using test::Scans;
using testing::HasSubstr;

class ImageFile : public testing::Test {
 protected:
  test::TemporaryFolder folder_;
  ImagePool pool_;
};

TEST_F(ImageFile, GrayPngComesBackBitForBit) {
  const Image image = noise(53, 31, pool_);  // a width that is no multiple of the row's alignment
  for (const auto effort : {PngEffort::kFast, PngEffort::kSmall}) {
    writePng(folder_ / "a.png", image, effort);
    expectEqual(readImage(folder_ / "a.png", pool_), image);
  }
}

TEST_F(ImageFile, ColorPngBecomesGrayByItsLuma) {
  RgbImage color{20, 16, std::vector<std::uint8_t>(20 * 16 * 3)};
  for (int x = 0; x < 20; ++x) {
    for (int y = 0; y < 16; ++y) {
      color.at(x, y)[0] = static_cast<std::uint8_t>(10 * x);
      color.at(x, y)[1] = static_cast<std::uint8_t>(15 * y);
      color.at(x, y)[2] = 77;
    }
  }
  writePngRgb(folder_ / "c.png", color);
  const Image gray = readImage(folder_ / "c.png", pool_);
  for (int x = 0; x < 20; ++x)
    for (int y = 0; y < 16; ++y)
      EXPECT_NEAR(gray.at(x, y), 0.299 * 10 * x + 0.587 * 15 * y + 0.114 * 77, 1.0);  // rounding of the weights
}

TEST_F(ImageFile, ColorPicturesAreMadeInMemoryToo) {
  RgbImage color{40, 32, {}};
  for (int i = 0; i < 40 * 32; ++i) color.pixels.insert(color.pixels.end(), {200, 30, 90});
  constexpr double kLuma = 0.299 * 200 + 0.587 * 30 + 0.114 * 90;
  const Image png = decodeImage(encodePng(color), "made.png", pool_);
  const Image jpeg = decodeImage(encodeJpeg(color, 95), "made.jpg", pool_);
  for (const Image& image : {png, jpeg}) {
    EXPECT_EQ(image.width(), 40);
    EXPECT_EQ(image.height(), 32);
    EXPECT_NEAR(image.at(20, 16), kLuma, 3);  // JPEG rounds the colors
  }
  EXPECT_NEAR(png.at(3, 30), kLuma, 1);
}

TEST_F(ImageFile, SixteenBitPngKeepsItsValuesAndItsUpperByteAsGray) {
  Gray16Image image{17, 19, std::vector<std::uint16_t>(17 * 19)};
  for (std::size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = static_cast<std::uint16_t>(i * 199);
  writePng16(folder_ / "d.png", image);
  EXPECT_EQ(readPng16(folder_ / "d.png").pixels, image.pixels);
  EXPECT_EQ(readImage(folder_ / "d.png", pool_).at(5, 3), image.pixels[3 * 17 + 5] >> 8);
}

TEST_F(ImageFile, PgmIsReadInBinaryAndInAscii) {
  const Image image = noise(18, 16, pool_);
  std::string binary = "P5\n# a comment\n18 16\n255\n", ascii = "P2 18 16 255\n";
  for (int y = 0; y < 16; ++y) {
    for (int x = 0; x < 18; ++x) {
      binary += static_cast<char>(image.at(x, y));
      ascii += std::to_string(image.at(x, y));
      ascii += ' ';
    }
  }
  expectEqual(readImage(folder_.write("a.pgm", binary), pool_), image);
  expectEqual(readImage(folder_.write("b.pgm", ascii), pool_), image);
}

TEST_F(ImageFile, FormatIsToldByContentNotByName) {
  const Image image = noise(64, 32, pool_);
  const auto file = folder_.write("really_jpeg.png", jpegOf(image));
  EXPECT_EQ(imageFormat(file), ImageFormat::kJpeg);
  const Image back = readImage(file, pool_);
  EXPECT_EQ(readImageSize(file), (ImageSize{64, 32}));
  for (int x = 0; x < 64; ++x) EXPECT_NEAR(back.at(x, 7), image.at(x, 7), 4);  // quality 100 still rounds
}

TEST_F(ImageFile, EveryCutOfAFileIsAnErrorThatNamesIt) {
  const Image image = noise(40, 24, pool_);
  writePng(folder_ / "whole.png", image);
  std::string pgm = "P5 40 24 255\n";
  for (int y = 0; y < 24; ++y) pgm.append(reinterpret_cast<const char*>(image.row(y)), 40);
  for (const std::string& whole : {folder_.read("whole.png"), jpegOf(image), pgm}) {
    for (std::size_t length = 0; length + 2 < whole.size(); length += 7) {
      const auto file = folder_.write("cut.png", std::string_view(whole).substr(0, length));
      EXPECT_THAT(messageOf<InputError>([&] { readImage(file, pool_); }), HasSubstr("cut.png")) << length;
    }
  }
}

TEST_F(ImageFile, BrokenBytesNeverCrash) {
  const Image image = noise(40, 24, pool_);
  writePng(folder_ / "whole.png", image);
  std::mt19937 random(1);
  for (const std::string& whole : {folder_.read("whole.png"), jpegOf(image)}) {
    for (int trial = 0; trial < 300; ++trial) {
      std::string broken = whole;
      for (int i = 0; i < 3; ++i) broken[random() % broken.size()] = static_cast<char>(random());
      const auto file = folder_.write("broken.png", broken);
      try {
        readImage(file, pool_);
      } catch (const InputError&) {
        continue;
      }
    }
  }
}

TEST_F(ImageFile, AbsurdSizesAreRefusedFromTheHeader) {
  writePng(folder_ / "a.png", noise(40, 24, pool_));
  std::string png = folder_.read("a.png");
  png.replace(16, 8, std::string("\x7f\xff\xff\xff\x7f\xff\xff\xff"));
  EXPECT_THAT(messageOf<InputError>([&] { readImage(folder_.write("a.png", png), pool_); }),
              HasSubstr("2147483647x2147483647"));
  EXPECT_THAT(messageOf<InputError>([&] { readImage(folder_.write("a.pgm", "P5 99999 99999 255\n"), pool_); }),
              HasSubstr("99999"));
  png.replace(16, 8, std::string("\0\0\x40\0\0\0\x40\0", 8));
  EXPECT_THAT(messageOf<InputError>([&] { readImage(folder_.write("a.png", png), pool_); }),
              HasSubstr("16384x16384 pixels, more than 67108864"));
  EXPECT_THAT(messageOf<InputError>([&] {
                readImage(folder_.write("a.pgm", "P5 800 600 255\n"), pool_, ImageSize{40, 24});
              }),
              HasSubstr("has 800x600 pixels, the sequence has 40x24"));
  EXPECT_EQ(pool_.buffersMade(), 1u) << "only the image that was written";
}

TEST_F(ImageFile, RefusesFilesOfMoreBytesThanAllowed) {
  const std::string large = "P5 1100 1000 255\n" + std::string(std::size_t{1100} * 1000, 'x');
  const std::filesystem::path file = folder_.write("large.pgm", large);
  EXPECT_NO_THROW(readImage(file, pool_, {}, 2));
  EXPECT_THAT(messageOf<InputError>([&] { readImage(file, pool_, {}, 1); }), HasSubstr("large.pgm"));
}

TEST_F(ImageFile, PixelsThatTheFileCannotHoldAreRefusedBeforeTheyGetMemory) {
  writePng(folder_ / "a.png", noise(40, 24, pool_));
  std::string png = folder_.read("a.png");
  png.replace(16, 8, std::string("\0\0\x20\0\0\0\x20\0", 8));
  for (const std::string& bytes :
       {png, std::string("P2 8192 8192 255\n1 2 3 "), std::string("P5 8192 8192 65535\n12")}) {
    EXPECT_THAT(messageOf<InputError>([&] { readImage(folder_.write("a", bytes), pool_); }),
                HasSubstr("the file ends early"));
  }
  EXPECT_THAT(messageOf<InputError>([&] { readPng16(folder_.write("a", png)); }), HasSubstr("the file ends early"));
  EXPECT_EQ(pool_.buffersMade(), 1u) << "only the image that was written";
}

/// Texts in a PNG inflate to up to 8 MB each, a thousand of them.
TEST_F(ImageFile, TextsInAPngTakeNoMemory) {
  const Image image = noise(40, 24, pool_);
  writePng(folder_ / "a.png", image);
  std::string png = folder_.read("a.png"), zeros(4 << 20, 'x'), packed(zeros.size(), 0);
  uLongf length = packed.size();
  ASSERT_EQ(compress(reinterpret_cast<Bytef*>(packed.data()), &length, reinterpret_cast<const Bytef*>(zeros.data()),
                     zeros.size()),
            Z_OK);
  packed.resize(length);
  std::string texts;
  for (int i = 0; i < 100; ++i) texts += test::pngChunk("zTXtkey" + std::string(2, '\0') + packed);
  constexpr std::size_t kAfterHeader = 33;  // signature and IHDR
  png.insert(kAfterHeader, texts);
  const auto file = folder_.write("a.png", png);
  const auto peak_kB = [] {
    rusage usage{};
    ::getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
  };
  const long before_kB = peak_kB();
  expectEqual(readImage(file, pool_), image);
  EXPECT_LT(peak_kB() - before_kB, 100'000);  // of 400 MB
}

/// A progressive JPEG whose last scan comes again and again: each one goes over the whole image.
TEST_F(ImageFile, JpegsOfThousandsOfScansAreRefused) {
  const std::string jpeg = jpegOf(noise(64, 64, pool_), Scans::kProgressive);
  const auto scan = jpeg.rfind("\xFF\xDA");
  ASSERT_NE(scan, std::string::npos);
  const std::string last(jpeg, scan, jpeg.size() - 2 - scan);
  std::string many = jpeg.substr(0, scan);
  for (int i = 0; i < 3000; ++i) many += last;
  const auto file = folder_.write("many.jpg", many + "\xFF\xD9");
  EXPECT_THAT(
      messageOf<InputError>([&] { readImage(file, pool_); }),
      HasSubstr("many.jpg: damaged image: "));  // too many scans, or out of sequence: libjpeg looks first or we do
  EXPECT_NO_THROW(readImage(folder_.write("few.jpg", jpeg), pool_));
}

TEST_F(ImageFile, WritingWhereNothingCanBeWrittenIsAnOutputError) {
  const Image image = noise(640, 480, pool_);
  EXPECT_THAT(messageOf<OutputError>([&] { writePng(folder_ / "no/such/folder.png", image); }),
              HasSubstr("folder.png"));
  EXPECT_THAT(messageOf<OutputError>([&] { writePng("/dev/full", image); }), HasSubstr("is a device"));
}

}  // namespace
}  // namespace motorcade
