#include "io/stream/y4m_source.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "tests/io/stream/piped_text.hpp"
#include "tests/io/temporary_folder.hpp"
#include "tests/support/y4m_stream_text.hpp"

namespace motorcade {
namespace {

using testing::HasSubstr;

const GivenCameras kGiven{.camera = "300,310,160,80,0.5"};

Sequence described(const std::string& header, const GivenCameras& given = kGiven) {
  return sequenceOfStream(parseY4mHeader("YUV4MPEG2 W640 H160 " + header, "stream"), StereoPacking::kSideBySide, given);
}

TEST(StreamSequence, HasTheGivenCameraWithTheSizeOfOneImage) {
  const Sequence sequence = described("F10:1 Cmono");
  EXPECT_TRUE(sequence.streamed());
  EXPECT_EQ(sequence.layout, "y4m_side_by_side");
  EXPECT_EQ(sequence.camera.width_px, 320);
  EXPECT_EQ(sequence.camera.height_px, 160);
  EXPECT_EQ(sequence.camera.fy_px, 310);
  EXPECT_EQ(sequence.given.camera, kGiven.camera);
  EXPECT_TRUE(sequence.frames.empty());
  EXPECT_TRUE(sequence.notes.empty());
  EXPECT_FALSE(sequence.rectification);
}

TEST(StreamSequence, IsRectifiedWhereTheCalibrationSaysSo) {
  const test::TemporaryFolder folder;
  const auto file = folder.write("stereo.yml",
                                 "M1: [300, 0, 160, 0, 300, 80, 0, 0, 1]\nM2: [300, 0, 160, 0, 300, 80, 0, 0, 1]\n"
                                 "D1: [-0.1, 0.01, 0, 0, 0]\nD2: [-0.1, 0.01, 0, 0, 0]\n"
                                 "R: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nT: [-0.5, 0, 0]\n");
  const Sequence sequence = described("F10:1", {.calibration = file.string()});
  EXPECT_TRUE(sequence.rectification);
  EXPECT_EQ(sequence.calibrated_by, file.string());
}

TEST(StreamSequence, SaysHowDeepSamplesAreTaken) {
  EXPECT_FALSE(described("C420").samples);
  EXPECT_EQ(described("C420p10").samples.value().bits, 10);
}

TEST(StreamSequence, NotesInterlacedPictures) {
  const Sequence sequence = described("It");
  ASSERT_EQ(sequence.notes.size(), 1U);
  EXPECT_TRUE(sequence.notes.front().worthless);
  EXPECT_THAT(sequence.notes.front().text, HasSubstr("yadif"));
}

TEST(StreamSequence, TakesGrayPicturesAloneForAMosaic) {
  const GivenCameras mosaic{.camera = kGiven.camera, .bayer = "RGGB"};
  EXPECT_TRUE(described("Cmono", mosaic).bayer);
  EXPECT_THROW(described("C420", mosaic), InputError);
}

constexpr ImageSize kSize{320, 160};
constexpr StereoPacking kPacking = StereoPacking::kOverUnder;
const GivenCameras kCameras{.camera = "300,300,160,80,0.5"};

/// A frame whose left image has the gray level `number`, and its right one the next.
std::string numberedFrame(int number) {
  ImagePool pool;
  const auto filled = [&pool](int level) {
    Image image = pool.acquire(kSize.width, kSize.height);
    for (int y = 0; y < kSize.height; ++y)
      std::fill_n(image.mutableRow(y), kSize.width, static_cast<std::uint8_t>(level));
    return image;
  };
  return test::y4mFrame(filled(number), filled(number + 1), kPacking);
}

/// A source at the end of a pipe into which the header has been written.
class PipedSource {
 public:
  explicit PipedSource(Y4mSource::Params params) {
    pipe.write(test::y4mHeaderLine(kSize, kPacking));
    auto stream = std::make_unique<Y4mStream>(pipe.reader(), "pipe");
    const Sequence sequence = sequenceOfStream(stream->header(), kPacking, kCameras);
    params.packing = kPacking;
    source = std::make_unique<Y4mSource>(std::move(stream), sequence, params);
  }
  std::vector<std::int64_t> numbersOfAll() const {
    std::vector<std::int64_t> numbers;
    while (const auto frame = source->next()) numbers.push_back(frame->head.frame.value);
    return numbers;
  }

  test::Pipe pipe;
  std::unique_ptr<Y4mSource> source;
};

TEST(Y4mSource, GivesPairsWithNumbersTimesAndImages) {
  PipedSource piped({.rate_hz = 10});
  for (const int number : {0, 1, 2}) piped.pipe.write(numberedFrame(number));
  piped.pipe.close();
  for (const int number : {0, 1, 2}) {
    const auto frame = piped.source->next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->head.frame.value, number);
    EXPECT_EQ(frame->head.stamp.ns, number * 100'000'000);
    EXPECT_EQ(frame->left.at(319, 159), number);
    EXPECT_EQ(frame->right.at(0, 0), number + 1);
    EXPECT_EQ(frame->due, SteadyTime{}) << "in replay a pair is due when it is taken";
  }
  EXPECT_FALSE(piped.source->next());
  const SourceEnd end = piped.source->finish();
  EXPECT_EQ(end.remark, "");
  EXPECT_FALSE(end.damaged);
}

TEST(Y4mSource, GivesTheFramesOfARangeAlone) {
  PipedSource piped({.range = {2, 4}});
  for (int number = 0; number < 6; ++number) piped.pipe.write(numberedFrame(number));
  EXPECT_EQ(piped.source->first().value, 2);
  EXPECT_THAT(piped.numbersOfAll(), testing::ElementsAre(2, 3)) << "without waiting for the stream's end";
  EXPECT_EQ(piped.source->finish().remark, "");
}

TEST(Y4mSource, TellsAStreamThatEndsWithinAPicture) {
  PipedSource piped({});
  piped.pipe.write(numberedFrame(0) + numberedFrame(1).substr(0, 1000));
  piped.pipe.close();
  EXPECT_THAT(piped.numbersOfAll(), testing::ElementsAre(0));
  const SourceEnd end = piped.source->finish();
  EXPECT_EQ(end.remark, "pipe: the stream ends within a picture, after 1 pair");
  EXPECT_FALSE(end.damaged);
}

TEST(Y4mSource, IsDamagedWhereNothingUsableCame) {
  const auto endOf = [](const std::string& bytes, FrameRange range) {
    PipedSource piped({.range = range});
    piped.pipe.write(bytes);
    piped.pipe.close();
    piped.numbersOfAll();
    return piped.source->finish();
  };
  EXPECT_THAT(endOf("", {}).remark, HasSubstr("the stream ends after 0 pairs"));
  EXPECT_TRUE(endOf("", {}).damaged);
  EXPECT_TRUE(endOf("FRAME\nx", {}).damaged);
  EXPECT_THAT(endOf(numberedFrame(0), {3}).remark, HasSubstr("after 1 pair, before the first of --frames"));
  EXPECT_THAT(endOf(numberedFrame(0) + "junk\n", {}).remark, HasSubstr("a line FRAME"));
  EXPECT_TRUE(endOf(numberedFrame(0) + "junk\n", {}).damaged);
}

TEST(Y4mSource, EndsWhenItIsStoppedWhileThePipeIsSilent) {
  PipedSource piped({});
  piped.pipe.write(numberedFrame(0).substr(0, 100));
  const std::jthread stopper([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    piped.source->stop();
  });
  EXPECT_FALSE(piped.source->next());
  EXPECT_EQ(piped.source->finish().remark, "") << "that the picture is not whole is nobody's fault";
}

/// Number of bytes that go into the pipe until it takes no more for a while; at most `most`.
std::size_t writtenAtMost(const PipedSource& piped, const std::string& text, std::size_t most) {
  ::fcntl(piped.pipe.writer(), F_SETFL, O_NONBLOCK);
  constexpr int kPatience = 20;
  std::size_t written = 0;
  for (int silent = 0; silent < kPatience && written < most;) {
    const std::size_t at = written % text.size();
    const ssize_t taken = ::write(piped.pipe.writer(), text.data() + at, text.size() - at);
    silent = taken > 0 ? 0 : silent + 1;
    if (taken > 0) written += static_cast<std::size_t>(taken);
    if (taken <= 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  ::fcntl(piped.pipe.writer(), F_SETFL, 0);
  return written;
}

TEST(Y4mSource, LetsTheWriterWaitWherePairsAreNotTaken) {
  constexpr std::size_t kAhead = 2, kPipe = 1 << 20;
  PipedSource piped({.ahead = kAhead});
  const std::string frame = numberedFrame(7);
  const std::size_t written = writtenAtMost(piped, frame, 100 * frame.size());
  EXPECT_LE(written, kPipe + (kAhead + 2) * frame.size());
  EXPECT_LE(piped.source->capacity(), kAhead);
  piped.source->stop();
}

TEST(Y4mSource, NeverLetsTheWriterWaitWhereTheNewestPairIsTaken) {
  constexpr int kFrames = 60;
  PipedSource piped({.newest = true});
  const std::string frame = numberedFrame(7);
  constexpr std::size_t kPipe = 1 << 20;
  for (int i = 0; i < kFrames; ++i) ASSERT_TRUE(piped.pipe.write(frame));  // nobody takes one
  piped.pipe.close();
  const auto numbers = piped.numbersOfAll();
  ASSERT_FALSE(numbers.empty());
  EXPECT_GE(numbers.front(), kFrames - 3 - static_cast<std::int64_t>(kPipe / frame.size()));
  EXPECT_EQ(numbers.back(), kFrames - 1);
}

TEST(Y4mSource, PairsOfALiveStreamAreDueWhenTheyAreThere) {
  PipedSource piped({.newest = true});
  const auto before = std::chrono::steady_clock::now();
  piped.pipe.write(numberedFrame(0));
  const auto frame = piped.source->next();
  ASSERT_TRUE(frame);
  EXPECT_GE(frame->due, before);
  EXPECT_EQ(frame->due, frame->decoded);
  EXPECT_GE(frame->decode_ms, 0);
}

}  // namespace
}  // namespace motorcade
