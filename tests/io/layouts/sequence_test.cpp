#include "io/sequence/sequence.hpp"

#include <map>
#include <thread>

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "io/images/image_file.hpp"
#include "io/inputs/sequence_decoder.hpp"
#include "io/layouts/open_sequence.hpp"
#include "io/truth/ground_truth.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using test::messageOf;
using testing::AllOf;
using testing::HasSubstr;

constexpr std::string_view kCalib =
    "P0: 700 0 320 0 0 700 100 0 0 0 1 0\n"
    "P1: 700 0 320 -350 0 700 100 0 0 0 1 0\n"
    "P2: 700 0 320 42.32 0 700 100 0.1 0 0 1 0.001\n"
    "P3: 700 0 320 -350 0 700 100 1 0 0 1 0.001\n";

std::string fileName(int i, const std::string& extension = ".png") {
  std::string digits = std::to_string(i);
  return std::string(6 - digits.size(), '0') + digits + extension;
}

class SequenceTest : public testing::Test {
 protected:
  void writeImages(const std::filesystem::path& name, int count, int width = 32) {
    std::filesystem::create_directories(folder_ / name);
    Image image = pool_.acquire(width, 16);
    for (int i = 0; i < count; ++i) {
      for (int y = 0; y < 16; ++y) std::fill_n(image.mutableRow(y), width, static_cast<std::uint8_t>(i));
      writePng(folder_ / name / fileName(i), image);
    }
  }
  void writePlain(int count) {
    writeImages("image_0", count);
    writeImages("image_1", count);
    folder_.write("calib.txt", kCalib);
  }
  std::string openError() {
    return messageOf<InputError>([&] { openSequence(folder_.path()); });
  }

  test::TemporaryFolder folder_;
  ImagePool pool_;
};

TEST_F(SequenceTest, PlainFolderGivesCameraFramesAndTimesAtTheGivenRate) {
  writePlain(3);
  const Sequence sequence = openSequence(folder_.path(), 20);
  EXPECT_EQ(sequence.layout, "plain");
  EXPECT_EQ(sequence.frames.size(), 3u);
  EXPECT_DOUBLE_EQ(sequence.camera.baseline_m, 0.5);
  EXPECT_EQ(sequence.camera.width_px, 32);
  EXPECT_EQ(sequence.camera.height_px, 16);
  EXPECT_FALSE(sequence.stamps_measured);
  EXPECT_EQ(sequence.stamps[2].ns, 100'000'000);
}

TEST_F(SequenceTest, ColorPairTakesItsOwnProjections) {
  writeImages("image_02", 2);
  writeImages("image_03", 2);
  folder_.write("calib.txt", kCalib);
  const Sequence sequence = openSequence(folder_.path());
  EXPECT_EQ(sequence.pair, CameraPair::kColor);
  EXPECT_NEAR(sequence.camera.baseline_m, 392.32 / 700, 1e-12);
  const auto t = sequence.calibration.T_left_cam0(sequence.pair).translation();
  EXPECT_NEAR(t.x(), (42.32 - 320 * 0.001) / 700, 1e-12);
  EXPECT_NEAR(t.z(), 0.001, 1e-12);
}

TEST_F(SequenceTest, TrackingLayoutIsFoundFromItsLeftImagesOrFromItsNumber) {
  writeImages("training/image_02/0003", 2);
  writeImages("training/image_03/0003", 2);
  folder_.write("training/calib/0003.txt", kCalib);
  folder_.write("training/label_02/0003.txt", "");
  folder_.write("training/oxts/0003.txt", "");
  for (const char* name :
       {"training/image_02/0003", "training/image_02/0003/", "training/0003", "training/image_02/../image_02/0003"}) {
    const Sequence sequence = openSequence(folder_ / name);
    EXPECT_EQ(sequence.layout, "tracking") << name;
    EXPECT_EQ(sequence.frames.size(), 2u);
    EXPECT_EQ(sequence.truth.labels.filename(), "0003.txt");
    EXPECT_FALSE(sequence.truth.oxts.empty());
  }
}

TEST_F(SequenceTest, TrackingWithoutItsRightImagesNamesTheArchive) {
  writeImages("training/image_02/0003", 2);
  folder_.write("training/calib/0003.txt", kCalib);
  EXPECT_THAT(messageOf<InputError>([&] { openSequence(folder_ / "training/image_02/0003"); }),
              testing::AllOf(HasSubstr("training/image_03/0003: is missing"), HasSubstr("data_tracking_image_3.zip")));
}

TEST_F(SequenceTest, OdometryLayoutFindsItsPosesBesideTheSequences) {
  writeImages("sequences/04/image_0", 2);
  writeImages("sequences/04/image_1", 2);
  folder_.write("sequences/04/calib.txt", kCalib);
  folder_.write("sequences/04/times.txt", "0.000000e+00\n1.041284e-01\n");
  folder_.write("poses/04.txt", "");
  const Sequence sequence = openSequence(folder_ / "sequences/04");
  EXPECT_EQ(sequence.layout, "odometry");
  EXPECT_EQ(sequence.truth.poses, folder_ / "poses/04.txt");
  EXPECT_TRUE(sequence.stamps_measured);
  EXPECT_EQ(sequence.stamps[1].ns, 104'128'400);
}

TEST_F(SequenceTest, RawLayoutReadsTheDatesCalibrationAndClock) {
  const std::string drive = "2011_09_26/2011_09_26_drive_0013_sync/";
  writeImages(drive + "image_00/data", 2);
  writeImages(drive + "image_01/data", 2);
  folder_.write(drive + "image_00/timestamps.txt", "2011-09-26 13:10:51.174740992\n2011-09-26 13:10:51.278236416\n");
  folder_.write(drive + "oxts/timestamps.txt", "");
  folder_.write(drive + "oxts/data/0000000000.txt", "");
  folder_.write("2011_09_26/calib_cam_to_cam.txt",
                "calib_time: 09-Jan-2012 13:57:47\ncorner_dist: 9.95e-02\nR_rect_00: 1 0 0 0 1 0 0 0 1\n"
                "P_rect_00: 700 0 320 0 0 700 100 0 0 0 1 0\nP_rect_01: 700 0 320 -350 0 700 100 0 0 0 1 0\n");
  folder_.write("2011_09_26/calib_velo_to_cam.txt",
                "calib_time: x\nR: 0 -1 0 0 0 -1 1 0 0\nT: 0 -0.1 -0.3\ndelta_f: 0 0\n");
  folder_.write("2011_09_26/calib_imu_to_velo.txt", "R: 1 0 0 0 1 0 0 0 1\nT: -0.8 0.3 -0.8\n");
  const Sequence sequence = openSequence(folder_ / drive);
  EXPECT_EQ(sequence.layout, "raw");
  EXPECT_EQ(sequence.stamps[1].ns - sequence.stamps[0].ns, 103'495'424);
  EXPECT_EQ(sequence.stamps[0].ns, 1317042651174740992);  // date -u -d '2011-09-26 13:10:51' +%s
  EXPECT_TRUE(sequence.calibration.T_cam0_imu());
  EXPECT_FALSE(sequence.truth.oxts_timestamps.empty());
}

TEST_F(SequenceTest, MissingPartsAreNamed) {
  EXPECT_THAT(openError(), HasSubstr("holds no stereo sequence"));
  writeImages("image_0", 3);
  writeImages("image_1", 3);
  EXPECT_THAT(openError(), HasSubstr("calib.txt"));
  folder_.write("calib.txt", "P0: 700 0 320 0 0 700 100 0 0 0 1 0\n");
  EXPECT_THAT(openError(), AllOf(HasSubstr("calib.txt"), HasSubstr("P1")));
  folder_.write("calib.txt", "P0: 700 0 320 0 0 700 100 0 0 0 1 0\nP1: 700 0 320\n");
  EXPECT_THAT(openError(), AllOf(HasSubstr("P1"), HasSubstr("12")));
  folder_.write("calib.txt", "P0: 700 0 320 0 0 700 100 0 0 0 1 0\nP1: 700 0 32x 0 0 700 100 0 0 0 1 0\n");
  EXPECT_THAT(openError(), AllOf(HasSubstr("line 2"), HasSubstr("32x")));
  folder_.write("calib.txt", "P0: 700 0 320 0 0 700 100 0 0 0 1 0\nP1: 700 0 320 350 0 700 100 0 0 0 1 0\n");
  EXPECT_THAT(openError(), HasSubstr("baseline"));
  folder_.write("calib.txt", kCalib);
  folder_.write("times.txt", "0\n0.1\n");
  EXPECT_THAT(openError(), AllOf(HasSubstr("times.txt"), HasSubstr("2 times for 3 images")));
  folder_.write("times.txt", "0\n0.1\n0.1\n");
  EXPECT_THAT(openError(), AllOf(HasSubstr("times.txt"), HasSubstr("line 3")));
}

TEST_F(SequenceTest, AnImageWithoutPartnerCostsItsFrameAlone) {
  writePlain(6);
  std::filesystem::remove(folder_ / "image_1/000002.png");
  std::filesystem::remove(folder_ / "image_0/000004.png");
  const Sequence sequence = openSequence(folder_.path());
  ASSERT_EQ(sequence.frames.size(), 6U);
  EXPECT_EQ(sequence.stamps[5].ns, 500'000'000);
  ASSERT_EQ(sequence.notes.size(), 1U);
  EXPECT_THAT(sequence.notes[0].text, AllOf(HasSubstr("image_0/000004.png"), HasSubstr("image_1/000002.png")));
  SequenceDecoder decoder(sequence, {});
  for (int i = 0; i < 6; ++i) {
    const auto frame = decoder.next();
    EXPECT_EQ(frame->head.frame.value, i);
    EXPECT_EQ(frame->problem.empty(), i != 2 && i != 4) << frame->problem;
    if (i == 5) {
      EXPECT_EQ(frame->left.at(5, 5), 5);
      EXPECT_EQ(frame->right.at(5, 5), 5);
    }
  }
}

TEST_F(SequenceTest, PosesAndLabelsFollowTheImagesThatAreThere) {
  writePlain(6);
  std::filesystem::remove(folder_ / "image_0/000002.png");
  std::string poses;
  for (const int number : {0, 1, 3, 4, 5}) poses += "1 0 0 0 0 1 0 0 0 0 1 " + std::to_string(number) + "\n";
  folder_.write("poses.txt", poses);
  const std::string label = " 7 Car 0 0 0 10 2 20 8 1.5 1.6 4 0 0 10 0\n";
  folder_.write("label_02.txt", "1" + label + "2" + label);  // lines of the poses: the numbers 1 and 3
  const Sequence sequence = openSequence(folder_.path());
  const auto camera = readCameraTruth(sequence);
  ASSERT_TRUE(camera);
  ASSERT_EQ(camera->T_world_cam.size(), 6U);
  for (int i = 0; i < 6; ++i) EXPECT_NEAR(camera->T_world_cam[i].translation().z(), i, 1e-9);
  const auto objects = readObjectTruths(sequence, *camera);
  ASSERT_EQ(objects->objects.size(), 2U);
  EXPECT_EQ(objects->objects[1].frame.value, 3);
  folder_.write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  EXPECT_THAT(messageOf<InputError>([&] { readCameraTruth(openSequence(folder_.path())); }),
              AllOf(HasSubstr("poses.txt: has 1 poses"), HasSubstr("each left image (5)")));
}

TEST_F(SequenceTest, TimesInAnotherUnitAreReadAndTold) {
  writePlain(4);
  const std::map<std::string, std::string> files{{"0\n100\n200\n301\n", "milliseconds"},
                                                 {"1403636579763555\n1403636579863555\n1403636579963555\n"
                                                  "1403636580064555\n",
                                                  "microseconds"},
                                                 {"1403636579763555584\n1403636579863555584\n1403636579963555584\n"
                                                  "1403636580064555584\n",
                                                  "nanoseconds"}};
  for (const auto& [times, unit] : files) {
    folder_.write("times.txt", times);
    const Sequence sequence = openSequence(folder_.path());
    EXPECT_EQ(sequence.stamps[3].ns - sequence.stamps[2].ns, 101'000'000) << unit;
    ASSERT_EQ(sequence.notes.size(), 1U);
    EXPECT_EQ(sequence.notes[0].name, "times");
    EXPECT_THAT(sequence.notes[0].text, HasSubstr(unit));
  }
  folder_.write("times.txt", "# seconds\n0\n0.1\n0.2\n0.3\n");
  EXPECT_TRUE(openSequence(folder_.path()).notes.empty());
  folder_.write("times.txt", "0\n0.00001\n0.00002\n0.00003\n");
  EXPECT_TRUE(openSequence(folder_.path()).notes.at(0).worthless);
}

TEST_F(SequenceTest, PairOfDifferentSizesIsRefused) {
  writePlain(2);
  writeImages("image_1", 2, 48);
  EXPECT_THAT(openError(), AllOf(HasSubstr("32x16"), HasSubstr("48x16")));
}

TEST_F(SequenceTest, FrameRangesAreReadAndBadOnesRefused) {
  EXPECT_EQ(parseFrameRange("3:7").size(), 4u);
  EXPECT_EQ(parseFrameRange("3:").within(10).size(), 7u);
  EXPECT_EQ(parseFrameRange(":4").within(2).size(), 2u);
  EXPECT_EQ(parseFrameRange("20:30").within(10).size(), 0u);
  for (const char* bad : {"", "5", "5:5", "7:3", "a:b", "-1:4", "1:2:3"})
    EXPECT_THROW(parseFrameRange(bad), UsageError) << bad;
}

TEST_F(SequenceTest, DecoderGivesTheFramesInOrderAndKeepsItsBound) {
  writePlain(20);
  SequenceDecoder decoder(openSequence(folder_.path()), {2, 18}, {.ahead = 4});
  std::this_thread::sleep_for(std::chrono::milliseconds(50));  // time to run ahead as far as it may
  for (int i = 2; i < 18; ++i) {
    const auto frame = decoder.next();
    ASSERT_TRUE(frame);
    EXPECT_EQ(frame->head.frame.value, i);
    EXPECT_FALSE(frame->rejected());
    EXPECT_EQ(frame->left.at(5, 5), i);
  }
  EXPECT_FALSE(decoder.next());
  EXPECT_LE(decoder.highWater(), 4u);
}

TEST_F(SequenceTest, DamagedOrMissizedImagesBecomeRejectedFrames) {
  writePlain(4);
  folder_.write("image_0/000001.png", "\x89PNG\r\n\x1a\n and then nothing");
  Image wide = pool_.acquire(40, 16);
  writePng(folder_ / "image_1/000002.png", wide);
  folder_.write("image_0/000000.png", "");
  SequenceDecoder decoder(openSequence(folder_.path()), {});
  EXPECT_THAT(decoder.next()->problem, HasSubstr("000000.png"));
  EXPECT_THAT(decoder.next()->problem, HasSubstr("000001.png"));
  EXPECT_THAT(decoder.next()->problem, AllOf(HasSubstr("000002.png"), HasSubstr("40x16")));
  EXPECT_FALSE(decoder.next()->rejected());
}

TEST_F(SequenceTest, OfAPairWithTwoDamagedImagesTheLeftOneIsNamed) {
  writePlain(3);
  for (const char* file : {"image_0/000001.png", "image_1/000001.png"}) folder_.write(file, "no image");
  SequenceDecoder decoder(openSequence(folder_.path()), {});
  EXPECT_FALSE(decoder.next()->rejected());
  const auto damaged = decoder.next();
  EXPECT_THAT(damaged->problem, HasSubstr("image_0/000001.png"));
  EXPECT_TRUE(damaged->left.empty() && damaged->right.empty());
  const auto good = decoder.next();
  EXPECT_FALSE(good->rejected());
  EXPECT_EQ(good->left.at(5, 5), 2);
  EXPECT_EQ(good->right.at(5, 5), 2);
}

TEST_F(SequenceTest, DecoderLeavesOutUnwantedPairsButNeverTheLast) {
  writePlain(10);
  const Sequence sequence = openSequence(folder_.path());
  const auto third = [&](Timestamp stamp) { return stamp == sequence.stamps[3]; };
  SequenceDecoder decoder(sequence, {1, 8}, {.ahead = 4, .wanted = third});
  EXPECT_EQ(decoder.next()->head.frame.value, 3);
  EXPECT_EQ(decoder.next()->head.frame.value, 7);
  EXPECT_FALSE(decoder.next());
  EXPECT_EQ(decoder.stampOf({7}), sequence.stamps[7]);
}

TEST_F(SequenceTest, DecoderStopsEarly) {
  writePlain(20);
  const SequenceDecoder abandoned(openSequence(folder_.path()), {}, {.ahead = 2});
}

}  // namespace
}  // namespace motorcade
