#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "io/images/image_file.hpp"
#include "io/inputs/pair_reader.hpp"
#include "io/layouts/open_sequence.hpp"
#include "io/sequence/sequence.hpp"
#include "tests/io/images/png_sample.hpp"
#include "tests/io/temporary_folder.hpp"

/// Drives whose images have samples of 16 bits, or are mosaics: what comes out is what 8-bit gray would have been.
namespace motorcade {
namespace {

namespace fs = std::filesystem;
using test::messageOf;
using testing::AllOf;
using testing::HasSubstr;

void overwrite(const fs::path& file, const std::string& bytes) { std::ofstream(file, std::ios::binary) << bytes; }

constexpr int kWidth = 40, kHeight = 24, kPairs = 7;

class SamplesOfDrive : public testing::Test {
 protected:
  /// An 8-bit picture, white at one place; darker by pair.
  static std::uint8_t pictureAt(int pair, StereoSide side, int x, int y) {
    if (x == 3 && y == 5 && pair == 3) return 255;
    return static_cast<std::uint8_t>((31 * x + 17 * y + 11 * pair + (side == StereoSide::kLeft ? 0 : 3)) %
                                     (200 - pair));
  }
  using Sample = std::function<int(std::uint8_t gray)>;
  using Write = std::function<void(const fs::path& file, const Gray16Image& image)>;

  static Gray16Image picture(int pair, StereoSide side, const Sample& sample) {
    Gray16Image image{kWidth, kHeight, {}};
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        image.pixels.push_back(static_cast<std::uint16_t>(sample(pictureAt(pair, side, x, y))));
    return image;
  }
  Sequence drive(const Sample& sample, const Write& write, const GivenCameras& given = {}) {
    folder_.write("calib.txt", "P0: 50 0 20 0 0 50 12 0 0 0 1 0\nP1: 50 0 20 -25 0 50 12 0 0 0 1 0\n");
    for (const StereoSide side : {StereoSide::kLeft, StereoSide::kRight}) {
      const fs::path folder = folder_ / (side == StereoSide::kLeft ? "left" : "right");
      fs::create_directories(folder);
      for (int pair = 0; pair < kPairs; ++pair)
        write(folder / ("00" + std::to_string(pair) + ".png"), picture(pair, side, sample));
    }
    return openSequence(folder_.path(), 10, given);
  }
  /// Each pixel of each image is that of the 8-bit picture, changed.
  static void expectPicture(const Sequence& sequence, const std::function<int(std::uint8_t)>& expected) {
    PairReader reader(sequence);
    for (int pair = 0; pair < kPairs; ++pair)
      for (const StereoSide side : {StereoSide::kLeft, StereoSide::kRight}) {
        const Image image = reader.read(sequence.frames[static_cast<std::size_t>(pair)], side);
        for (int y = 0; y < kHeight; ++y)
          for (int x = 0; x < kWidth; ++x)
            ASSERT_EQ(image.at(x, y), expected(pictureAt(pair, side, x, y))) << pair << " " << x << " " << y;
      }
  }
  static void writeDeep(const fs::path& file, const Gray16Image& image) { writePng16(file, image); }
  /// Writes an image with an sBIT chunk, which tells the camera's bits.
  static void writeTold(const fs::path& file, const Gray16Image& image, char bits) {
    writePng16(file, image);
    std::string bytes = readImageBytes(file);
    bytes.insert(33, test::pngChunk(std::string("sBIT") + bits));
    overwrite(file, bytes);
  }
  static void writePgm(const fs::path& file, const Gray16Image& image, int white) {
    std::string bytes =
        "P5\n" + std::to_string(kWidth) + " " + std::to_string(kHeight) + "\n" + std::to_string(white) + "\n";
    for (const std::uint16_t sample : image.pixels)
      bytes += {static_cast<char>(sample >> 8), static_cast<char>(sample)};
    overwrite(file, bytes);
  }

  test::TemporaryFolder folder_;
};

int same(std::uint8_t gray) { return gray; }

TEST_F(SamplesOfDrive, OfTenTwelveAndFourteenBitsAreThoseOfEight) {
  for (const int more_bits : {2, 4, 6}) {
    const Sequence sequence = drive([&](std::uint8_t gray) { return gray << more_bits; }, writeDeep);
    ASSERT_TRUE(sequence.samples);
    EXPECT_EQ(sequence.samples->bits, 8 + more_bits);
    EXPECT_THAT(sequence.samples->why, HasSubstr("brightest"));
    expectPicture(sequence, same);
  }
}

TEST_F(SamplesOfDrive, OfEightBitsInSixteenStayAsTheyAre) {
  const Sequence sequence = drive(same, writeDeep);
  EXPECT_EQ(sequence.samples->bits, 8);
  expectPicture(sequence, same);
}

TEST_F(SamplesOfDrive, OfAllBitsLoseTheLowerByte) {
  const Sequence sequence = drive([](std::uint8_t gray) { return gray * 257; }, writeDeep);
  EXPECT_EQ(sequence.samples->bits, kAllSampleBits);
  expectPicture(sequence, same);
}

TEST_F(SamplesOfDrive, FollowWhatTheFileTellsHoweverDarkTheyAre) {
  const auto dark = [](std::uint8_t gray) { return gray; };  // of 12 bits: up to 255 of 4095
  const Sequence sequence = drive(dark, [](const fs::path& f, const Gray16Image& i) { writeTold(f, i, 12); });
  EXPECT_EQ(sequence.samples->bits, 12);
  EXPECT_THAT(sequence.samples->why, HasSubstr("sBIT"));
  expectPicture(sequence, [](std::uint8_t gray) { return gray >> 4; });
}

/// The PNG specification wants samples of ten bits scaled up to sixteen, and sBIT to tell of it.
TEST_F(SamplesOfDrive, ThatTheFileHasScaledUpLoseTheLowerByte) {
  const Sequence sequence = drive([](std::uint8_t gray) { return gray * 257; },
                                  [](const fs::path& f, const Gray16Image& i) { writeTold(f, i, 10); });
  EXPECT_EQ(sequence.samples->bits, kAllSampleBits);
  expectPicture(sequence, same);
}

TEST_F(SamplesOfDrive, OfPgmAreScaledByTheirMaximum) {
  const auto white_at = [](int white) {
    return [white](const fs::path& file, const Gray16Image& image) { writePgm(file, image, white); };
  };
  const auto ten_bits = [](std::uint8_t gray) { return 4 * gray; };
  const Sequence told = drive(ten_bits, white_at(1020));
  EXPECT_THAT(told.samples->why, HasSubstr("1020"));
  expectPicture(told, same);
  const Sequence untold = drive(ten_bits, white_at(65535));
  EXPECT_EQ(untold.samples->bits, 10);
  expectPicture(untold, same);
}

/// Some programs write an image's own brightest sample as the maximum: followed, the drive would flicker.
TEST_F(SamplesOfDrive, OfPgmWithAMaximumForEachImageHaveOneScale) {
  const Sequence sequence = drive([](std::uint8_t gray) { return 4 * gray; },
                                  [](const fs::path& f, const auto& i) { writePgm(f, i, std::ranges::max(i.pixels)); });
  EXPECT_EQ(sequence.samples->bits, 10);
  expectPicture(sequence, same);
}

TEST_F(SamplesOfDrive, ADamagedImageIsPassedOver) {
  drive([](std::uint8_t gray) { return 4 * gray; }, writeDeep);
  folder_.write("left/000.png", folder_.read("left/000.png").substr(0, 60));
  folder_.write("right/000.png", "");
  const Sequence sequence = openSequence(folder_.path());
  ASSERT_TRUE(sequence.samples);
  EXPECT_EQ(sequence.samples->bits, 10);
}

TEST_F(SamplesOfDrive, OfEightBitsNeedNoScale) {
  const Sequence sequence = drive(same, [](const fs::path& file, const Gray16Image& image) {
    ImagePool pool;
    Image gray = pool.acquire(image.width, image.height);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        gray.mutableRow(y)[x] =
            static_cast<std::uint8_t>(image.pixels[static_cast<std::size_t>(y) * kWidth + static_cast<std::size_t>(x)]);
    writePng(file, gray);
  });
  EXPECT_FALSE(sequence.samples);
  EXPECT_FALSE(sequence.bayer);
  expectPicture(sequence, same);
}

TEST_F(SamplesOfDrive, OfAMosaicBecomeItsGrayInEightAndInSixteenBits) {
  for (const int more_bits : {0, 2, 8}) {
    const Sequence sequence = drive([&](std::uint8_t gray) { return gray << more_bits; }, writeDeep, {.bayer = "grbg"});
    ASSERT_TRUE(sequence.bayer);
    EXPECT_EQ(sequence.given.bayer, "grbg");
    PairReader reader(sequence);
    ImagePool pool;
    Image mosaic = pool.acquire(kWidth, kHeight);
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) mosaic.mutableRow(y)[x] = pictureAt(2, StereoSide::kRight, x, y);
    const Image expected = grayOfMosaic(mosaic, BayerPattern::kGrbg, pool),
                read = reader.read(sequence.frames[2], StereoSide::kRight);
    for (int y = 0; y < kHeight; ++y) ASSERT_TRUE(std::equal(read.row(y), read.row(y) + kWidth, expected.row(y))) << y;
  }
}

TEST_F(SamplesOfDrive, ACalibrationMayTellOfTheMosaic) {
  const std::string cameras =
      "M1: [50, 0, 20, 0, 50, 12, 0, 0, 1]\nM2: [50, 0, 20, 0, 50, 12, 0, 0, 1]\nD1: [0, 0, 0, 0]\nD2: [0, 0, 0, 0]\n"
      "R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nT: [-0.5, 0, 0]\n";
  const auto opened = [&](const std::string& more, const std::string& given) {
    const fs::path file = folder_.write("stereo.yaml", cameras + more);
    return drive(same, writeDeep, {.calibration = file.string(), .bayer = given}).bayer;
  };
  EXPECT_EQ(opened("bayer_pattern: BGGR\n", ""), BayerPattern::kBggr);
  EXPECT_EQ(opened("bayer_pattern: BGGR\n", "RGGB"), BayerPattern::kRggb) << "what the user says comes first";
  EXPECT_EQ(opened("", ""), std::nullopt);
  EXPECT_THAT(messageOf<InputError>([&] { opened("bayer_pattern: yes\n", ""); }),
              AllOf(HasSubstr("stereo.yaml"), HasSubstr("bayer_pattern"), HasSubstr("write RGGB")));
}

TEST_F(SamplesOfDrive, AMosaicHasOneOfFourPatternsAndNoColors) {
  EXPECT_THAT(messageOf<UsageError>([&] { drive(same, writeDeep, {.bayer = "RGBG"}); }),
              HasSubstr("write RGGB, BGGR, GRBG or GBRG"));
  const Write colored = [](const fs::path& file, const Gray16Image& image) {
    RgbImage rgb{image.width, image.height, std::vector<std::uint8_t>(3 * image.pixels.size(), 80)};
    writePngRgb(file, rgb);
  };
  EXPECT_THAT(messageOf<InputError>([&] { drive(same, colored, {.bayer = "RGGB"}); }), HasSubstr("has colors"));
}

}  // namespace
}  // namespace motorcade
