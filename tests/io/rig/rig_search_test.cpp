#include "io/rig/rig_search.hpp"

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "io/rig/rig_file.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using test::messageOf;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

std::string openCvRig(const std::string& x_m) {
  return "M1: [500, 0, 376, 0, 501, 240, 0, 0, 1]\nM2: [502, 0, 370, 0, 503, 241, 0, 0, 1]\nD1: [0, 0, 0, 0, 0]\n"
         "D2: [0, 0, 0, 0, 0]\nR: [1, 0, 0, 0, 1, 0, 0, 0, 1]\nT: [" +
         x_m + ", 0, 0]\n";
}

std::string ros(const std::string& fourth) {
  return "K: [430, 0, 306, 0, 430, 227, 0, 0, 1]\nD: [0, 0, 0, 0, 0]\nR: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
         "P: [400, 0, 310, " +
         fourth + ", 0, 401, 230, 0, 0, 0, 1, 0]\n";
}

class RigSearch : public testing::Test {
 protected:
  std::vector<std::string> found(RigNames names = RigNames::kUsual) {
    std::vector<std::string> files;
    for (const auto& file : usualRigFiles(folder_.path(), names)) files.push_back(file.filename());
    return files;
  }
  std::string error() {
    return messageOf<InputError>([&] { found(); });
  }
  test::TemporaryFolder folder_;
};

TEST_F(RigSearch, SeveralThatDifferAreAskedFor) {
  folder_.write("camchain-2023-01.yaml", openCvRig("-0.432"));
  EXPECT_THAT(found(), ElementsAre("camchain-2023-01.yaml"));
  folder_.write("camchain-2024-09.yaml", openCvRig("-0.54"));
  EXPECT_THAT(error(), AllOf(HasSubstr("holds 2 calibrations"), HasSubstr("2023-01.yaml    (baseline 0.4320 m)"),
                             HasSubstr("--calibration " + (folder_ / "camchain-2024-09.yaml").string())));
  folder_.write("camchain-2024-09.yaml", "cam0: {intrinsics: [0, 0, 0, 0]}\ncam1: 1\n");
  EXPECT_THAT(error(), HasSubstr("2024-09.yaml    (cannot be used)"));
}

TEST_F(RigSearch, SeveralThatAreOneAreNoQuestion) {
  folder_.write("camchain.yaml", openCvRig("-0.54"));
  folder_.write("camchain-imucam.yaml", openCvRig("-0.54000000001"));
  EXPECT_THAT(found(), ElementsAre("camchain-imucam.yaml"));
}

TEST_F(RigSearch, PairsAreFoundByTheirNames) {
  for (const auto& [left, right] :
       {std::pair("zed_left.yaml", "zed_right.yaml"), std::pair("LeftInfo.yml", "RightInfo.yml")}) {
    const auto first = folder_.write(left, ros("0")), second = folder_.write(right, ros("-48"));
    EXPECT_THAT(found(), ElementsAre(left, right));
    std::filesystem::remove(first);
    std::filesystem::remove(second);
  }
  folder_.write("left.yaml", ros("0"));
  folder_.write("right.yaml", ros("-48"));
  folder_.write("stereo_old.yml", openCvRig("-0.13"));
  EXPECT_THAT(error(), AllOf(HasSubstr("left.yaml," + (folder_ / "right.yaml").string()), HasSubstr("stereo_old.yml")));
}

TEST_F(RigSearch, OtherNamesAndOtherContentsDoNotCount) {
  folder_.write("rig.yaml", openCvRig("-0.54"));
  folder_.write("calibration_of_the_imu.yaml", "noise: 1\n");
  EXPECT_THAT(found(), IsEmpty());
  EXPECT_THAT(found(RigNames::kAny), ElementsAre("rig.yaml"));
  folder_.write("stereo.json", "{\"M1\": 1}");
  EXPECT_THAT(found(), ElementsAre("stereo.json"));  // though it cannot be read: the message is that of the file
}

TEST_F(RigSearch, OptionIsQuotedWhereItsFilesHaveBlanks) {
  EXPECT_EQ(calibrationArgument({"/a/left.yaml", "/a/right.yaml"}), "--calibration /a/left.yaml,/a/right.yaml");
  EXPECT_EQ(calibrationArgument({"/my drive/it's.yaml"}), "--calibration '/my drive/it'\\''s.yaml'");
  EXPECT_THAT(calibrationArgument({"/a/$b.yaml"}), Not(HasSubstr(" /a")));
}

}  // namespace
}  // namespace motorcade
