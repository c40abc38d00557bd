#include <algorithm>
#include <cstdint>
#include <mutex>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "tests/interface/tracked_drive.hpp"

namespace motorcade {
namespace {

/// The same picture in other formats, with other strides, as the sensor's driver hands it on.
class Formats : public testing::Test {
 protected:
  const DriveInMemory drive_ = readDrive(MOTORCADE_SMALL_SEQUENCE);

  static std::vector<std::uint8_t> drawn(const std::vector<std::uint8_t>& gray, int width, const Pair::Image& as) {
    const auto bytes = as.format == Pair::Format::kGray8 ? 1 : as.format == Pair::Format::kGray16 ? 2 : 3;
    const auto rows = static_cast<std::int64_t>(gray.size()) / width;
    std::vector<std::uint8_t> image(static_cast<std::size_t>(rows * as.stride_bytes), 0xA5);
    for (std::int64_t y = 0; y < rows; ++y)
      for (int x = 0; x < width; ++x) {
        const std::uint8_t value = gray[static_cast<std::size_t>(y * width + x)];
        auto* pixel = &image[static_cast<std::size_t>(y * as.stride_bytes + std::int64_t{x} * bytes)];
        if (bytes == 2)
          pixel[0] = static_cast<std::uint8_t>(17 * x), pixel[1] = value;  // little-endian: the upper eight bits last
        else
          std::fill_n(pixel, bytes, value);
      }
    return image;
  }
  std::vector<std::string> resultsAs(Pair::Format format, std::int64_t stride_bytes) {
    std::vector<std::uint8_t> left, right;
    return bytesOf(track(drive_, replay(), [&](std::size_t index) {
      Pair pair = drive_.pair(index);
      for (auto [image, pixels, gray] : {std::tuple(&pair.left, &left, &drive_.frames[index].left),
                                         std::tuple(&pair.right, &right, &drive_.frames[index].right)}) {
        image->format = format;
        image->stride_bytes = stride_bytes;
        *pixels = drawn(*gray, drive_.camera.width_px, *image);
        image->pixels = pixels->data();
      }
      return pair;
    }));
  }
};

TEST_F(Formats, OfTheSamePictureGiveTheSameResults) {
  const auto expected = bytesOf(track(drive_));
  const int width_px = drive_.camera.width_px;
  EXPECT_EQ(resultsAs(Pair::Format::kGray8, width_px + 3), expected);
  EXPECT_EQ(resultsAs(Pair::Format::kGray16, 2 * width_px + 1), expected);  // rows at odd addresses
  EXPECT_EQ(resultsAs(Pair::Format::kRgb8, 3 * width_px), expected);
  EXPECT_EQ(resultsAs(Pair::Format::kBgr8, 3 * width_px + 64), expected);
}

TEST_F(Formats, OfIgnoredPixelsGiveTheSameResults) {
  constexpr int kRows = 40;
  DriveInMemory sides = drive_, mask = drive_;
  const auto row_px = static_cast<std::size_t>(drive_.camera.width_px);
  sides.camera.ignored.bottom_px = kRows;
  mask.camera.ignored.mask.resize(row_px * static_cast<std::size_t>(drive_.camera.height_px - kRows), 0);
  mask.camera.ignored.mask.resize(row_px * static_cast<std::size_t>(drive_.camera.height_px), 255);
  const auto expected = bytesOf(track(sides));
  EXPECT_EQ(bytesOf(track(mask)), expected);
  EXPECT_NE(bytesOf(track(drive_)), expected);
}

/// Cameras of ten to fourteen bits hand their samples on as they are. The first pair is dark: the second one tells.
TEST_F(Formats, OfFewerBitsInSixteenGiveTheSameResults) {
  const auto darkFirst = [&](std::size_t index, std::uint8_t gray) {
    return static_cast<std::uint8_t>(index == 0 ? gray / 8 : gray);
  };
  std::vector<std::uint8_t> left8, right8;
  std::vector<std::uint16_t> left16, right16;
  const auto expected = bytesOf(track(drive_, replay(), [&](std::size_t index) {
    Pair pair = drive_.pair(index);
    left8 = drive_.frames[index].left, right8 = drive_.frames[index].right;
    for (std::uint8_t& gray : left8) gray = darkFirst(index, gray);
    for (std::uint8_t& gray : right8) gray = darkFirst(index, gray);
    pair.left.pixels = left8.data(), pair.right.pixels = right8.data();
    return pair;
  }));
  for (const int more_bits : {0, 2, 4, 6}) {
    std::vector<std::string> lines;
    std::mutex mutex;
    Tracker::Options options = replay();
    options.log = [&](Tracker::LogLevel, const std::string& text) {
      const std::scoped_lock lock(mutex);
      if (text.starts_with("images of 16 bits")) lines.push_back(text);
    };
    const auto deep = [&](std::size_t index, const std::vector<std::uint8_t>& gray, std::vector<std::uint16_t>& out) {
      out.clear();
      // The first pair has so few levels that as eight bits they are what they are.
      for (const std::uint8_t value : gray)
        out.push_back(static_cast<std::uint16_t>(index == 0 ? darkFirst(index, value) : value << more_bits));
      return out.data();
    };
    EXPECT_EQ(bytesOf(track(drive_, options,
                            [&](std::size_t index) {
                              Pair pair = drive_.pair(index);
                              pair.left.pixels = deep(index, drive_.frames[index].left, left16);
                              pair.right.pixels = deep(index, drive_.frames[index].right, right16);
                              pair.left.format = pair.right.format = Pair::Format::kGray16;
                              return pair;
                            })),
              expected)
        << more_bits;
    ASSERT_EQ(lines.size(), more_bits == 0 ? 0U : 1U) << "said once, when it is known";
    for (const std::string& line : lines)
      EXPECT_NE(line.find("taken as " + std::to_string(8 + more_bits)), std::string::npos) << line;
  }
}

/// Red is bright in one order of the colors, and dark in the other: weights 77 and 29 of 256.
TEST_F(Formats, OfColorsDifferInTheOrderOfTheirBytes) {
  std::vector<std::uint8_t> colors, other;
  const auto results = [&](Pair::Format format, int bright) {
    return bytesOf(track(drive_, replay(), [&, bright](std::size_t index) {
      Pair pair = drive_.pair(index);
      const auto draw = [&](const std::vector<std::uint8_t>& gray, std::vector<std::uint8_t>& out, Pair::Image& image) {
        out.assign(3 * gray.size(), 0);
        for (std::size_t i = 0; i < gray.size(); ++i) out[3 * i + static_cast<std::size_t>(bright)] = gray[i];
        image.pixels = out.data();
        image.format = format;
      };
      draw(drive_.frames[index].left, colors, pair.left);
      draw(drive_.frames[index].right, other, pair.right);
      return pair;
    }));
  };
  const auto red = results(Pair::Format::kRgb8, 0);
  EXPECT_EQ(results(Pair::Format::kBgr8, 2), red);
  EXPECT_NE(results(Pair::Format::kRgb8, 2), red);
}

}  // namespace
}  // namespace motorcade
