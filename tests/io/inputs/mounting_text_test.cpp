#include "io/inputs/mounting_text.hpp"

#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

/// Axes of a camera that is turned to the left, then rolled and pitched: where its axes point in the vehicle.
TEST(MountingText, IsAPlaceAndThreeTurns) {
  const auto isAhead = [](const std::string& mounting, const Eigen::Vector3d& expected) {
    return (parseMounting(mounting).rotation().col(0) - expected).norm() < 1e-12;
  };
  const SE3 straight = parseMounting("1.6,-0.4,1.5,0,0,0");
  EXPECT_EQ(straight.translation(), Eigen::Vector3d(1.6, -0.4, 1.5));
  EXPECT_EQ(straight.rotation(), Eigen::Matrix3d::Identity());
  EXPECT_TRUE(isAhead("0,0,0,0,0,90", {0, 1, 0})) << "yaw to the left";
  EXPECT_TRUE(isAhead("0,0,0,0,90,0", {0, 0, -1})) << "pitch down";
  EXPECT_TRUE(isAhead("0,0,0,90,90,0", {0, 0, -1})) << "roll comes before pitch";
  EXPECT_TRUE(isAhead("0,0,0,0,90,90", {0, 0, -1})) << "yaw comes last";
}

TEST(MountingText, TellsHowToWriteIt) {
  for (const char* const bad : {"", "1", "1,2,3,4,5", "1,2,3,4,5,6,7", "1,2,3,4,5,", "a,0,0,0,0,0", "1600,0,0,0,0,0",
                                "nan,0,0,0,0,0", "0,0,0,0,0,400"})
    EXPECT_THAT(test::messageOf<UsageError>([&] { parseMounting(bad); }),
                testing::HasSubstr("write X,Y,Z,ROLL,PITCH,YAW"))
        << bad;
}

}  // namespace
}  // namespace motorcade
