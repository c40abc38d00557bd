#include "io/stream/y4m_header.hpp"

#include <string>

#include <gmock/gmock.h>

#include "io/files/errors.hpp"

namespace motorcade {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Y4mHeader headerOf(const std::string& line) { return parseY4mHeader(line, "stream"); }

std::string refusalOf(const std::string& line) {
  try {
    headerOf(line);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(Y4mHeader, TellsWhatFfmpegWrites) {
  const Y4mHeader header = headerOf("YUV4MPEG2 W2484 H375 F30000:1001 Ip A0:0 Cmono XCOLORRANGE=FULL");
  EXPECT_EQ(header.width, 2484);
  EXPECT_EQ(header.height, 375);
  EXPECT_DOUBLE_EQ(header.rate_hz.value(), 30000.0 / 1001);
  EXPECT_FALSE(header.interlaced);
  EXPECT_EQ(header.bits, 8);
  EXPECT_EQ(header.lumaBytes(), 2484U * 375);
  EXPECT_EQ(header.chromaBytes(), 0U);
}

TEST(Y4mHeader, CountsTheBytesOfEachColorSpace) {
  struct Case {
    std::string space;
    int bits;
    std::size_t luma, chroma;  // of 7 by 5 pixels
  };
  for (const Case& expected :
       {Case{"", 8, 35, 24}, Case{" C420", 8, 35, 24}, Case{" C420jpeg", 8, 35, 24}, Case{" C420mpeg2", 8, 35, 24},
        Case{" C420paldv", 8, 35, 24}, Case{" C411", 8, 35, 20}, Case{" C422", 8, 35, 40}, Case{" C444", 8, 35, 70},
        Case{" C444alpha", 8, 35, 105}, Case{" Cmono", 8, 35, 0}, Case{" Cmono16", 16, 70, 0},
        Case{" Cmono10", 10, 70, 0}, Case{" C420p10", 10, 70, 48}, Case{" C444p12", 12, 70, 140}}) {
    const Y4mHeader header = headerOf("YUV4MPEG2 W7 H5" + expected.space);
    EXPECT_EQ(header.bits, expected.bits) << expected.space;
    EXPECT_EQ(header.lumaBytes(), expected.luma) << expected.space;
    EXPECT_EQ(header.chromaBytes(), expected.chroma) << expected.space;
  }
}

TEST(Y4mHeader, HasNoRateWhereTheStreamTellsNone) {
  for (const char* rate : {"", " F0:0", " F0:1", " F25:0"})
    EXPECT_FALSE(headerOf(std::string("YUV4MPEG2 W64 H32") + rate).rate_hz) << rate;
}

TEST(Y4mHeader, KnowsInterlacedPictures) {
  for (const char* field : {"It", "Ib", "Im"})
    EXPECT_TRUE(headerOf(std::string("YUV4MPEG2 W64 H32 ") + field).interlaced);
  for (const char* field : {"Ip", "I?"}) EXPECT_FALSE(headerOf(std::string("YUV4MPEG2 W64 H32 ") + field).interlaced);
}

TEST(Y4mHeader, NamesWhatIsWrong) {
  EXPECT_THAT(refusalOf("RIFF\x01\x1b[31m"), AllOf(HasSubstr("stream: is no YUV4MPEG2 stream"), HasSubstr("ffmpeg")));
  EXPECT_THAT(refusalOf("RIFF\x01\x1b[31m"), testing::Not(HasSubstr("\x1b")));
  EXPECT_THAT(refusalOf("YUV4MPEG22 W64 H32"), HasSubstr("no YUV4MPEG2"));
  EXPECT_THAT(refusalOf("YUV4MPEG2 H32"), HasSubstr("no width or no height"));
  for (const char* field : {"W0", "W-4", "W40000", "W99999999999999999999", "Wide"})
    EXPECT_THAT(refusalOf(std::string("YUV4MPEG2 H32 ") + field), HasSubstr(field));
  for (const char* field : {"F10", "F10:", "F-1:1", "F1000000:1", "F1:2000"})
    EXPECT_THAT(refusalOf(std::string("YUV4MPEG2 W64 H32 ") + field), HasSubstr(field));
  for (const char* field : {"C420p17", "C420p4", "Cmonochrome", "C420what", "Cbgr", "C"})
    EXPECT_THAT(refusalOf(std::string("YUV4MPEG2 W64 H32 ") + field), HasSubstr("color space"));
}

}  // namespace
}  // namespace motorcade
