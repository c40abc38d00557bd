#include "io/stream/y4m_stream.hpp"

#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "tests/io/stream/piped_text.hpp"

namespace motorcade {
namespace {

using testing::HasSubstr;
using Next = Y4mStream::Next;

const std::string kHeader = "YUV4MPEG2 W4 H2 F10:1 C420\n";
const std::string kLuma = "abcdefgh", kChroma = "1234";

/// The frames of a stream of such bytes, as `frame TEXT`, and how it ends.
std::vector<std::string> framesOf(const std::string& bytes) {
  test::Pipe pipe;
  pipe.write(bytes);
  pipe.close();
  std::vector<std::string> frames;
  try {
    Y4mStream stream(pipe.reader(), "pipe");
    for (std::vector<std::uint8_t> luma;;) {
      const Next next = stream.next(luma);
      if (next != Next::kFrame) {
        frames.emplace_back(next == Next::kEnd ? "end" : next == Next::kCutShort ? "cut short" : "stopped");
        return frames;
      }
      frames.emplace_back(luma.begin(), luma.end());
    }
  } catch (const InputError& error) {
    frames.emplace_back(error.what());
    return frames;
  }
}

TEST(Y4mStream, GivesTheLumaPlaneOfEachFrame) {
  EXPECT_THAT(framesOf(kHeader + "FRAME\n" + kLuma + kChroma + "FRAME Ip XTIME=1\n" + "ABCDEFGH" + kChroma),
              testing::ElementsAre(kLuma, "ABCDEFGH", "end"));
  EXPECT_THAT(framesOf(kHeader), testing::ElementsAre("end"));
}

TEST(Y4mStream, TellsAnEndWithinAFrameFromOneAfterIt) {
  const std::string whole = "FRAME\n" + kLuma + kChroma, two = kHeader + whole + whole;
  for (std::size_t cut = 1; cut < whole.size(); ++cut)
    EXPECT_THAT(framesOf(two.substr(0, two.size() - cut)), testing::ElementsAre(kLuma, "cut short")) << cut;
}

TEST(Y4mStream, RefusesWhatIsNoFrame) {
  const std::string before = kHeader + "FRAME\n" + kLuma + kChroma;
  for (const std::string& no_frame : {std::string("FRAMES\n"), std::string("\n"), std::string(5000, 'x'),
                                      "FRAME " + std::string(5000, 'x'), std::string("junk")}) {
    const auto frames = framesOf(std::string(before).append(no_frame));
    ASSERT_EQ(frames.size(), 2U);
    EXPECT_THAT(frames.back(), HasSubstr("pipe: a frame should begin with a line FRAME"));
    EXPECT_LT(frames.back().size(), 300U);
  }
}

TEST(Y4mStream, TellsWhyThereIsNoHeader) {
  EXPECT_THAT(framesOf("").front(), HasSubstr("ends before it begins"));
  EXPECT_THAT(framesOf("YUV4MPEG2 W4 H").front(), HasSubstr("ends within the stream's header"));
  EXPECT_THAT(framesOf("YUV4MPEG2 " + std::string(5000, 'X')).front(), HasSubstr("no end within 4096 bytes"));
  EXPECT_THAT(framesOf("\x89PNG\r\n").front(), HasSubstr("is no YUV4MPEG2 stream"));
}

}  // namespace
}  // namespace motorcade
