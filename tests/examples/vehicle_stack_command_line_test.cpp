#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "command_line.hpp"

namespace vehicle_stack {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

CommandLine parsedOf(std::vector<const char*> words) {
  words.insert(words.begin(), "vehicle_stack");
  return parsed(static_cast<int>(words.size()), words.data());
}

std::string messageOf(const std::vector<const char*>& words) {
  try {
    parsedOf(words);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "";
}

TEST(VehicleStackCommandLine, SetsWhatItNames) {
  const CommandLine line =
      parsedOf({"DRIVE", "--rate", "20", "--loops", "3", "--pitch", "90", "--cpus", "0,1", "--stamps", "remade"});
  EXPECT_EQ(line.drive, "DRIVE");
  EXPECT_EQ(line.camera.rate_hz, 20);
  EXPECT_EQ(line.camera.loops, 3);
  EXPECT_NEAR(line.mounting.pitch_rad, 1.5708, 1e-4);
  EXPECT_THAT(line.tracker.cpus, ElementsAre(0, 1));
  EXPECT_EQ(line.camera.stamps, FolderCamera::Stamps::kRemade);
}

TEST(VehicleStackCommandLine, NamesTheOptionThatIsWrong) {
  EXPECT_THAT(messageOf({"DRIVE", "--rate", "fast"}), HasSubstr("--rate: takes a number"));
  EXPECT_THAT(messageOf({"DRIVE", "--rate", "0"}), HasSubstr("not '0'"));
  EXPECT_THAT(messageOf({"DRIVE", "--height", "nan"}), HasSubstr("--height"));
  EXPECT_THAT(messageOf({"DRIVE", "--cpus", "0,,1"}), HasSubstr("--cpus"));
  EXPECT_THAT(messageOf({"DRIVE", "--rate"}), HasSubstr("--rate: its value is missing"));
  EXPECT_THAT(messageOf({"DRIVE", "--fast", "1"}), HasSubstr("--fast: is no option"));
  EXPECT_THAT(messageOf({}), HasSubstr("DRIVE"));
}

}  // namespace
}  // namespace vehicle_stack
