#include "io/stream/stream_sequence.hpp"

#include <string>

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "tests/io/temporary_folder.hpp"

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

}  // namespace
}  // namespace motorcade
