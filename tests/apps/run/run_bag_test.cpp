#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "io/inputs/pair_reader.hpp"
#include "io/layouts/open_sequence.hpp"
#include "io/results/run_folder.hpp"
#include "io/sequence/sequence.hpp"
#include "tests/apps/program_run.hpp"
#include "tests/support/data_folder.hpp"
#include "tests/support/mcap_text.hpp"
#include "tests/support/ros_message_text.hpp"

/// `motorcade run FILE.mcap`: pairs out of a bag.
namespace motorcade::test {
namespace {

using testing::AllOf;
using testing::AnyOf;
using testing::HasSubstr;

class RunBag : public Run {
 protected:
  /// The pairs of a drive as a bag without camera_info.
  fs::path bagOf(const fs::path& drive, bool finished = true) {
    const Sequence sequence = openSequence(drive);
    PairReader reader(sequence);
    McapText text;
    text.magic().header();
    text.topic(1, "/left/image_raw", "sensor_msgs/msg/Image").topic(2, "/right/image_raw", "sensor_msgs/msg/Image");
    fs::path file = out("drive.mcap");
    std::ofstream bag(file, std::ios::binary);
    for (std::size_t i = 0; i < sequence.frames.size(); ++i) {
      const std::int64_t stamp_ns = sequence.stamps[i].ns;
      const auto image = [&](StereoSide side) {
        return rosImage(Wire::kCdr, stamp_ns, reader.read(sequence.frames[i], side));
      };
      const auto log_ns = static_cast<std::uint64_t>(stamp_ns);
      text.message(2, log_ns, image(StereoSide::kRight)).message(1, log_ns, image(StereoSide::kLeft));
      bag << text.text();
      text = McapText();
    }
    if (finished) bag << text.end().text();
    return file;
  }
  int runBag(const std::string& name, const fs::path& bag, const std::string& options = "") {
    return run(name, "--topics /left/image_raw,/right/image_raw " + rendered() + " " + options, bag);
  }
  static std::string rendered() { return "--calibration " + (kSequence / "calib.txt").string(); }
};

TEST_F(RunBag, GivesTheSameBytesAsTheFolder) {
  ASSERT_EQ(run("folder", rendered()), 0) << contentOf(errors());
  ASSERT_EQ(runBag("bag", bagOf(kSequence)), 0) << contentOf(errors());
  expectSame("folder", "bag");
  const auto json = summary("bag");
  EXPECT_EQ(json["layout"], "bag");
  EXPECT_EQ(json["sequence"], out("drive.mcap").string());
  EXPECT_EQ(json["complete"], true);
  EXPECT_EQ(json["images"]["pairs"], kFrames);
  EXPECT_DOUBLE_EQ(json["capture_rate_hz"].get<double>(), 10);
  EXPECT_TRUE(json["findings"].empty());
}

TEST_F(RunBag, GivesTheSameBytesAsTheFolderOfARealDrive) {
  const fs::path data = dataFolder() / "kitti_tracking_0003";
  if (!fs::exists(data)) GTEST_SKIP() << data << " is not there";
  const std::string calibration = "--calibration " + (data / "calib.txt").string();
  ASSERT_EQ(run("folder", calibration, data), 0) << contentOf(errors());
  ASSERT_EQ(run("bag", "--topics /left/image_raw,/right/image_raw " + calibration, bagOf(data)), 0)
      << contentOf(errors());
  expectSame("folder", "bag");
}

TEST_F(RunBag, RunsTheFramesThatAreAskedForAtThePaceThatIsAskedFor) {
  const fs::path bag = bagOf(kSequence);
  ASSERT_EQ(runBag("bag", bag, "--frames 3:9 --rate 40"), 0) << contentOf(errors());
  ASSERT_EQ(run("folder", "--frames 3:9 " + rendered()), 0) << contentOf(errors());
  expectSame("folder", "bag");
  EXPECT_EQ(summary("bag")["rate"], 40);
  EXPECT_EQ(runBag("none", bag, "--frames 50:"), 3);
  EXPECT_THAT(contentOf(errors()), HasSubstr("before the first of --frames"));
}

TEST_F(RunBag, InstanceLabelsComeBesideABagToo) {
  const fs::path labels = out("labels");
  fs::copy(kSequence / "instance", labels);
  fs::resize_file(labels / "000003.png", 60);
  ASSERT_EQ(runBag("bag", bagOf(kSequence), "--frames 2:6 --instances " + labels.string()), 0) << contentOf(errors());
  EXPECT_EQ(summary("bag")["instances"], labels.string());
  EXPECT_THAT(contentOf(errors()), HasSubstr("a file of instance labels is left out: "));
}

/// However many pairs are in time.
TEST_F(RunBag, LiveGivesEachPairItsLine) {
  EXPECT_THAT(runBag("live", bagOf(kSequence), "--live"), AnyOf(0, 3)) << contentOf(errors());
  const auto frames = summary("live")["frames"];
  EXPECT_EQ(frames["processed"].get<std::size_t>() + frames["dropped"].get<std::size_t>(), frames["received"]);
  EXPECT_EQ(summary("live")["rate"], 10);
  EXPECT_EQ(readRunFolder(out("live")).frames.size(), frames["received"].get<std::size_t>());
}

TEST_F(RunBag, AnUnfinishedBagIsToldAndEndsTheRunWell) {
  const fs::path bag = bagOf(kSequence, /*finished=*/false);
  fs::resize_file(bag, fs::file_size(bag) - 100);
  ASSERT_EQ(runBag("cut", bag), 0) << contentOf(errors());
  const std::string told = std::to_string(kFrames - 1) + " pairs came before";
  EXPECT_THAT(contentOf(errors()), AllOf(HasSubstr("drive.mcap: byte "), HasSubstr(told)));
  EXPECT_EQ(readRunFolder(out("cut")).final.camera.size(), kFrames - 1);
  const auto json = summary("cut");
  EXPECT_EQ(json["complete"], true);
  ASSERT_EQ(json["findings"].size(), 1U);
  EXPECT_EQ(json["findings"][0]["name"], "stream");
  fs::resize_file(bag, 1000);
  EXPECT_EQ(runBag("none", bag), 3);
}

TEST_F(RunBag, TopicsAreListedWhereNoneAreNamed) {
  const fs::path bag = bagOf(kSequence);
  EXPECT_EQ(motorcade("run " + bag.string()), 2);
  EXPECT_THAT(contentOf(errors()),
              AllOf(HasSubstr("sensor_msgs/msg/Image"), HasSubstr("--topics /left/image_raw,/right/image_raw")));
  EXPECT_EQ(motorcade("run " + bag.string() + " --topics /left/image_raw,/right/image_raw"), 2);
  EXPECT_THAT(contentOf(errors()), HasSubstr("--out is required"));
  EXPECT_EQ(run("none", "--topics /left,/right", bag), 2);
  EXPECT_THAT(contentOf(errors()), AllOf(HasSubstr("has no message of /left"), HasSubstr("/left/image_raw")));
}

TEST_F(RunBag, OptionsThatABagCannotMeetAreRefused) {
  const fs::path bag = bagOf(kSequence);
  const auto refusal = [&](const std::string& options) {
    EXPECT_EQ(runBag("refused", bag, options), 2) << options;
    return contentOf(errors());
  };
  EXPECT_THAT(refusal("--side-by-side"), HasSubstr("--side-by-side"));
  EXPECT_THAT(refusal("--camera-poses poses.txt"), HasSubstr("how many a bag has"));
  EXPECT_THAT(refusal("--inject truncated@3"), HasSubstr("a bag has none"));
  EXPECT_EQ(run("refused", "--topics /left,/right"), 2);
  EXPECT_THAT(contentOf(errors()), HasSubstr("--topics: tells of a bag"));
  EXPECT_EQ(run("refused", "--topics /left/image_raw,/right/image_raw", bag), 3);
  EXPECT_THAT(contentOf(errors()), AllOf(HasSubstr("/left/camera_info"), HasSubstr("--camera")));
}

TEST_F(RunBag, OtherCommandsSayThatTheImagesAreInTheBag) {
  const fs::path bag = bagOf(kSequence);
  ASSERT_EQ(runBag("bag", bag), 0) << contentOf(errors());
  EXPECT_EQ(motorcade("draw " + out("bag").string() + " --out " + out("pictures").string()), 3);
  EXPECT_THAT(contentOf(errors()), AllOf(HasSubstr("in the bag"), HasSubstr("--sequence")));
  EXPECT_EQ(motorcade("check " + bag.string()), 3);
  EXPECT_THAT(contentOf(errors()), HasSubstr("`run` alone reads"));
  evaluate("bag");
  EXPECT_EQ(motorcade("report " + out("bag").string()), 0) << contentOf(errors());
}

}  // namespace
}  // namespace motorcade::test
