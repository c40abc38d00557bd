#include <algorithm>
#include <cstdio>

#include <Eigen/Geometry>
#include <gmock/gmock.h>

#include "io/files/errors.hpp"
#include "io/truth/ground_truth.hpp"
#include "io/truth/trajectory.hpp"
#include "tests/io/temporary_folder.hpp"
#include "tests/support/matchers.hpp"

/// The forms in which people have the truth as poses.txt.
namespace motorcade {
namespace {

using test::IsNearPose;
using test::messageOf;
using testing::AllOf;
using testing::HasSubstr;

constexpr double kPrinted = 1e-8;

/// A drive of four frames at 10 Hz that goes 1 m ahead in each and turns.
class TruthFiles : public testing::Test {
 protected:
  TruthFiles() {
    for (int i = 0; i < 4; ++i) {
      sequence_.frames.push_back({"left/" + std::to_string(i) + ".png", "right/" + std::to_string(i) + ".png"});
      sequence_.stamps.push_back(stampOf(i));
    }
    sequence_.stamps_measured = true;
  }
  static Timestamp stampOf(int i) { return {i * 100'000'000LL}; }
  static SE3 poseOf(int i) { return {expSO3({0, 0.05 * i, 0}), Eigen::Vector3d(0.1 * i, 0, i)}; }
  /// A line for each frame, between `head` and nothing.
  template <class LineOf>
  CameraTruth truthOf(const LineOf& line_of, const std::string& head = "") {
    std::string text = head;
    for (int i = 0; i < 4; ++i) text += line_of(i) + "\n";
    sequence_.truth.poses = folder_.write("poses.txt", text);
    return *readCameraTruth(sequence_);
  }
  template <class LineOf>
  std::string refusalOf(const LineOf& line_of) {
    return messageOf<InputError>([&] { truthOf(line_of); });
  }
  void expectTruth(const CameraTruth& truth) {
    ASSERT_EQ(truth.T_world_cam.size(), 4U);
    for (int i = 0; i < 4; ++i) EXPECT_THAT(truth.T_world_cam[i], IsNearPose(poseOf(i), kPrinted)) << i;
  }
  static std::string tum(int i, std::int64_t offset_ns = 0) { return tumLine({stampOf(i).ns + offset_ns}, poseOf(i)); }

  test::TemporaryFolder folder_;
  Sequence sequence_;
};

TEST_F(TruthFiles, RowsOfTwelveOrSixteenNumbersAreRead) {
  expectTruth(truthOf([](int i) { return kittiLine(poseOf(i)); }));
  expectTruth(truthOf([](int i) { return kittiLine(poseOf(i)) + " 0 0 0 1"; }));
  expectTruth(truthOf([](int i) { return kittiLine(poseOf(i)); }, "# of the left camera\n"));
  expectTruth(truthOf([](int i) {
    std::string line = kittiLine(poseOf(i));
    std::ranges::replace(line, ' ', ',');
    return line;
  }));
}

TEST_F(TruthFiles, MatricesByColumnsAreRefused) {
  EXPECT_THAT(refusalOf([](int i) { return "1 0 0 0 0 1 0 0 0 0 1 0 0 0 " + std::to_string(i + 1) + " 1"; }),
              AllOf(HasSubstr("poses.txt, line 1"), HasSubstr("column by column")));
}

TEST_F(TruthFiles, ATrajectoryInTumFormIsReadByItsTimes) {
  expectTruth(truthOf([](int i) { return tum(i); }, "# timestamp tx ty tz qx qy qz qw\n"));
  // Of other times than the images': between them.
  const CameraTruth between = truthOf([](int i) {
    return tumLine({stampOf(i).ns + 40'000'000}, SE3(Eigen::Matrix3d::Identity(), {0, 0, i + 0.4}));
  });
  EXPECT_EQ(between.first_frame, 1);
  ASSERT_EQ(between.T_world_cam.size(), 4U);
  EXPECT_NEAR(between.T_world_cam[3].translation().z(), 2, 1e-6) << "2 m after frame 1, the first that is known";
}

TEST_F(TruthFiles, TimesOfTumAreNanosecondsWhereTheyCannotBeSeconds) {
  constexpr std::int64_t kEpoch_ns = 1'403'715'274'000'000'000;
  for (Timestamp& stamp : sequence_.stamps) stamp.ns += kEpoch_ns;
  expectTruth(truthOf([](int i) {
    const std::string line = tum(i);
    return std::to_string(stampOf(i).ns + kEpoch_ns) + ".000000" + line.substr(line.find(' '));
  }));
  EXPECT_THAT(refusalOf([](int i) { return std::to_string(1'403'715'274'000 + 100 * i) + " 0 0 0 0 0 0 1"; }),
              HasSubstr("seconds or nanoseconds"));
}

TEST_F(TruthFiles, TumOfAnotherClockIsReadWhereItHasAPoseForEachImage) {
  constexpr std::int64_t kEpoch_ns = 1'403'715'274'000'000'000;
  expectTruth(truthOf([](int i) { return tum(i, kEpoch_ns); }));
  EXPECT_THAT(refusalOf([](int i) { return tum(2 * i, kEpoch_ns); }), HasSubstr("must be of one clock"));
  sequence_.stamps_measured = false;
  for (std::size_t i = 0; i < 4; ++i) sequence_.stamps[i].ns = static_cast<std::int64_t>(i) * 103'000'000;
  expectTruth(truthOf([](int i) { return tum(i); }));
  sequence_.frames.pop_back();
  sequence_.stamps.pop_back();
  EXPECT_THAT(refusalOf([](int i) { return tum(i); }), AllOf(HasSubstr("poses.txt"), HasSubstr("times.txt")));
}

TEST_F(TruthFiles, ATrajectoryOfTooShortATimeIsRefused) {
  sequence_.truth.poses = folder_.write("poses.txt", tum(1) + "\n" + tumLine({stampOf(1).ns + 1000}, poseOf(1)) + "\n");
  EXPECT_THAT(messageOf<InputError>([&] { readCameraTruth(sequence_); }), HasSubstr("time of 1 of 4 images"));
}

TEST_F(TruthFiles, EurocsTableIsReadByItsTimes) {
  const auto line = [](int i) {
    const Eigen::Quaterniond q(poseOf(i).rotation());
    const Eigen::Vector3d t = poseOf(i).translation();
    char text[256];
    std::snprintf(text, sizeof(text), "%lld,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f,%.9f", static_cast<long long>(stampOf(i).ns),
                  t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z());
    return std::string(text);
  };
  expectTruth(truthOf(line, "#timestamp [ns],p_x,p_y,p_z,q_w,q_x,q_y,q_z\n"));
  expectTruth(truthOf(line, "timestamp,tx,ty,tz,qw,qx,qy,qz\n"));
}

TEST_F(TruthFiles, MatricesBehindNumbersOfImagesAreRead) {
  expectTruth(truthOf([](int i) { return std::to_string(i) + " " + kittiLine(poseOf(i)) + " 0 0 0 1"; }));
}

TEST_F(TruthFiles, OtherFormsAreNamedWithWhatIsRead) {
  const auto refused = [&](const std::string& line) { return refusalOf([&](int) { return line; }); };
  EXPECT_THAT(refused("0 0 1"), AllOf(HasSubstr("line 1: has 3 fields"), HasSubstr("12 numbers")));
  EXPECT_THAT(refused("1 0 0 0"), HasSubstr("matrix over four lines"));
  EXPECT_THAT(refused("0 0 1 0 0 0 1"), HasSubstr("without its times"));
  EXPECT_THAT(refused("0 1 0 0 0 0 1 0 0 0 0 1 0"), HasSubstr("cam0_to_world.txt"));
  EXPECT_THAT(refused("0.1 0 0 1 0 0 0 2"), HasSubstr("quaternion's length"));
  EXPECT_THAT(refused("nan 0 0 0 0 1 0 0 0 0 1 0"), AllOf(HasSubstr("line 1"), HasSubstr("not finite")));
  EXPECT_THAT(refused("# nothing"), HasSubstr("has 0 poses for 4 images"));
}

}  // namespace
}  // namespace motorcade
