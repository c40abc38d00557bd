#include "io/stream/stereo_packing.hpp"

#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "io/files/errors.hpp"

namespace motorcade {
namespace {

using testing::HasSubstr;

std::vector<std::uint8_t> counted(std::size_t bytes) {
  std::vector<std::uint8_t> samples(bytes);
  std::iota(samples.begin(), samples.end(), std::uint8_t{0});
  return samples;
}

TEST(StereoPacking, FindsEachImageWhereThePackingSays) {
  ImagePool pool;
  const auto luma = counted(4 * 2 * 2);
  const ImagePair beside = unpacked(luma, 8, StereoPacking::kSideBySide, {4, 2}, pool);
  EXPECT_EQ(beside.left.at(3, 1), 8 + 3);
  EXPECT_EQ(beside.right.at(3, 1), 8 + 4 + 3);
  const ImagePair above = unpacked(luma, 8, StereoPacking::kOverUnder, {4, 2}, pool);
  EXPECT_EQ(above.left.at(3, 1), 4 + 3);
  EXPECT_EQ(above.right.at(3, 1), 8 + 4 + 3);
}

TEST(StereoPacking, TakesTheUpperEightBitsOfLittleEndianSamples) {
  ImagePool pool;
  const std::vector<std::uint8_t> luma{0xff, 0x03, 0x00, 0x02, 0x04, 0x00, 0x00, 0x10};  // 1023, 512 | 4, 4096
  const ImagePair pair = unpacked(luma, 10, StereoPacking::kSideBySide, {2, 1}, pool);
  EXPECT_EQ(pair.left.at(0, 0), 255);
  EXPECT_EQ(pair.left.at(1, 0), 128);
  EXPECT_EQ(pair.right.at(0, 0), 1);
  EXPECT_EQ(pair.right.at(1, 0), 255) << "a sample of more bits than the header tells is white";
}

std::string packingRefusal(int width, int height, StereoPacking packing) {
  try {
    unpackedSize({.width = width, .height = height}, packing, "stream");
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(StereoPacking, RefusesSizesThatCannotBeHalvedAndThoseThatNoImageMayHave) {
  const ImageSize size = unpackedSize({.width = 128, .height = 33}, StereoPacking::kSideBySide, "stream");
  EXPECT_EQ(size, (ImageSize{64, 33}));
  EXPECT_THAT(packingRefusal(127, 64, StereoPacking::kSideBySide), HasSubstr("127x64, an odd width"));
  EXPECT_THAT(packingRefusal(128, 33, StereoPacking::kOverUnder), HasSubstr("128x33, an odd height"));
  EXPECT_THAT(packingRefusal(30, 64, StereoPacking::kSideBySide), HasSubstr("15x64"));
  EXPECT_THAT(packingRefusal(1 << 15, 1 << 14, StereoPacking::kSideBySide), HasSubstr("make the images smaller"));
}

}  // namespace
}  // namespace motorcade
