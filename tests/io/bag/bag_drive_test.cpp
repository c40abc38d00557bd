#include "io/bag/bag_drive.hpp"

#include <string>

#include <gmock/gmock.h>

#include "io/bag/bag_reader.hpp"
#include "io/files/errors.hpp"
#include "io/rig/rectification.hpp"
#include "tests/io/bag/numbered_bag.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using test::messageOf;
using test::NumberedBag;
using testing::AllOf;
using testing::HasSubstr;

class BagDriveTest : public testing::Test {
 protected:
  template <class Error>
  std::string refusalOf(const std::string& content, const std::string& topics = NumberedBag::kTopics,
                        const GivenCameras& given = {}) const {
    const auto file = folder_.write("bag.mcap", content);
    return messageOf<Error>([&] { openBagDrive(file, topics, given); });
  }
  BagDrive open(const std::string& content, const GivenCameras& given = {}) const {
    return openBagDrive(folder_.write("bag.mcap", content), NumberedBag::kTopics, given);
  }

  test::TemporaryFolder folder_;
};

TEST_F(BagDriveTest, CameraRateAndTimesAreThoseOfTheMessages) {
  const BagDrive drive = open(NumberedBag().pairs(0, 4).whole());
  EXPECT_EQ(drive.sequence.camera.fx_px, 300);
  EXPECT_EQ(drive.sequence.camera.baseline_m, 0.5);
  EXPECT_EQ(drive.sequence.camera.width_px, 320);
  EXPECT_FALSE(drive.sequence.rectification);
  EXPECT_TRUE(drive.sequence.streamed());
  EXPECT_FALSE(drive.sequence.piped());
  EXPECT_EQ(drive.sequence.calibrated_by, "/left/camera_info,/right/camera_info");
  EXPECT_EQ(drive.rate_hz, 10);
  EXPECT_EQ(drive.first.ns, NumberedBag::stampOf_ns(0));
}

TEST_F(BagDriveTest, RawImagesAreRectifiedByTheirMessages) {
  const BagDrive drive = open(NumberedBag(true, -0.2).pairs(0, 2).whole());
  ASSERT_TRUE(drive.sequence.rectification);
  EXPECT_EQ(drive.sequence.rectification->left.coefficients[0], -0.2);
  EXPECT_EQ(drive.sequence.camera.fx_px, 300);
  EXPECT_EQ(drive.sequence.camera.baseline_m, 0.5);
}

TEST_F(BagDriveTest, SamplesOf16BitsAreScaledByTheBrightest) {
  const auto deep = [](std::int64_t stamp_ns, std::uint8_t upper) {
    std::string pixels(2 * 320 * 160, '\0');
    pixels[2 * 320 + 1] = static_cast<char>(upper);
    test::RosMessageText message(test::Wire::kCdr);
    return message.head(stamp_ns).u32(160).u32(320).word("mono16").u8(0).u32(640).bytes(pixels).text();
  };
  NumberedBag bag;
  bag.message("left", deep(10, 1), 10).message("right", deep(10, 2), 10);
  bag.message("left", deep(20'000'000, 1), 20).message("right", deep(20'000'000, 0x0F), 20);
  const BagDrive drive = open(bag.whole());
  EXPECT_EQ(drive.conversion.sample_bits, 12);
  ASSERT_TRUE(drive.sequence.samples);
  EXPECT_THAT(drive.sequence.samples->why, HasSubstr("3840"));
}

TEST_F(BagDriveTest, TheUsersCameraComesBeforeTheBags) {
  EXPECT_EQ(open(NumberedBag().pairs(0, 2).whole(), {.camera = "310,310,160,80,0.4"}).sequence.camera.fx_px, 310);
  EXPECT_EQ(open(NumberedBag(false).pairs(0, 2).whole(), {.camera = "310,310,160,80,0.4"}).sequence.camera.fx_px, 310);
}

TEST_F(BagDriveTest, WithoutCameraInfoBothWaysOutAreNamed) {
  EXPECT_THAT(refusalOf<InputError>(NumberedBag(false).pairs(0, 2).whole()),
              AllOf(HasSubstr("/left/camera_info: has no message"), HasSubstr("--camera"), HasSubstr("--calibration")));
}

TEST_F(BagDriveTest, WithoutTopicsThoseThatAreThereAreListed) {
  const std::string bag = NumberedBag().pairs(0, 2).whole();
  EXPECT_THAT(refusalOf<UsageError>(bag, ""), AllOf(HasSubstr("/left/camera_info   sensor_msgs/msg/CameraInfo"),
                                                    HasSubstr("--topics /left/image_raw,/right/image_raw")));
  EXPECT_THAT(refusalOf<UsageError>(NumberedBag().pairs(0, 2).cut(), ""), HasSubstr("/right/image_raw"));
  EXPECT_THAT(refusalOf<UsageError>(bag, "/left/image_raw,/right"),
              AllOf(HasSubstr("has no message of /right"), HasSubstr("/right/image_raw")));
  EXPECT_THAT(refusalOf<UsageError>(bag, "/left/image_raw"), HasSubstr("write LEFT,RIGHT"));
  EXPECT_THAT(refusalOf<UsageError>(bag, "/a,/b,/c"), HasSubstr("write LEFT,RIGHT"));
  EXPECT_THAT(refusalOf<UsageError>(bag, "/a,/a"), HasSubstr("twice"));
}

TEST_F(BagDriveTest, ExchangedTopicsAreFoundByTheBaseline) {
  EXPECT_THAT(refusalOf<InputError>(NumberedBag().pairs(0, 2).whole(), "/right/image_raw,/left/image_raw"),
              HasSubstr("the topics are exchanged"));
}

TEST_F(BagDriveTest, TopicsOfOtherTypesAreNamed) {
  EXPECT_THAT(refusalOf<InputError>(NumberedBag().pairs(0, 2).whole(), "/left/camera_info,/right/camera_info"),
              HasSubstr("is of type sensor_msgs/msg/CameraInfo"));
}

TEST_F(BagDriveTest, ImagesWithoutPartnersAreToldOf) {
  NumberedBag bag;
  for (int number = 0; number < 5; ++number)
    bag.left(number).image("right", number, NumberedBag::stampOf_ns(number) + 30'000'000);
  EXPECT_THAT(
      refusalOf<InputError>(bag.whole()),
      AllOf(HasSubstr("of 5 left and 5 right images, no two have stamps within 5 ms"), HasSubstr("30 ms apart")));
}

TEST_F(BagDriveTest, ADamagedBagIsOpenedIfItHasAPair) {
  const std::string whole = NumberedBag().pairs(0, 1).whole();
  EXPECT_EQ(open(NumberedBag().pairs(0, 1).cut()).rate_hz, 10);
  EXPECT_THAT(refusalOf<InputError>(NumberedBag().left(0).cut()), HasSubstr("ends before it is finished"));
}

TEST_F(BagDriveTest, SidesOfDifferentSizesAreRefused) {
  ImagePool pool;
  const Image small = pool.acquire(160, 80);
  NumberedBag bag;
  bag.left(0).message("right", test::rosImage(test::Wire::kCdr, NumberedBag::stampOf_ns(0), small), 1);
  EXPECT_THAT(refusalOf<InputError>(bag.whole()), HasSubstr("has 160x80 pixels, the left image has 320x160"));
}

TEST_F(BagDriveTest, AFolderOfRosbag2IsItsFile) {
  const auto file = folder_.write("drive/drive_0.mcap", NumberedBag().pairs(0, 2).whole());
  const auto write = [&](const std::string& rest) {
    return folder_.write("drive/metadata.yaml", "rosbag2_bagfile_information:\n  version: 5\n" + rest);
  };
  write("  relative_file_paths:\n    - drive_0.mcap\n  compression_mode: \"\"\n");
  EXPECT_TRUE(isBag(file.parent_path()));
  EXPECT_EQ(openBagDrive(file.parent_path(), NumberedBag::kTopics, {}).rate_hz, 10);
  const auto refusal = [&] {
    return messageOf<InputError>([&] { openBagDrive(file.parent_path(), NumberedBag::kTopics, {}); });
  };
  write("  relative_file_paths:\n    - drive_0.mcap\n    - drive_1.mcap\n");
  EXPECT_THAT(refusal(), HasSubstr("names 2 files"));
  write("  relative_file_paths:\n    - drive_0.mcap.zstd\n  compression_mode: FILE\n");
  EXPECT_THAT(refusal(), HasSubstr("ros2 bag convert"));
}

TEST_F(BagDriveTest, OtherFilesAreNoBags) {
  EXPECT_FALSE(isBag(folder_.write("pairs.txt", "a.png b.png\n")));
  EXPECT_FALSE(isBag(folder_.path()));
  EXPECT_FALSE(isBag("-"));
  EXPECT_TRUE(isBag("not_there.mcap")) << "the message will be that it is not there";
  EXPECT_TRUE(isBag(folder_.write("no_suffix", NumberedBag().whole())));
  const auto ros1 = folder_.write("drive.mcap", "#ROSBAG V2.0\n");
  EXPECT_THAT(messageOf<InputError>([&] { openBag(ros1); }), HasSubstr("mcap convert"));
}

}  // namespace
}  // namespace motorcade
