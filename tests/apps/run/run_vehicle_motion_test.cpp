#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "core/se3.hpp"
#include "io/results/run_folder.hpp"
#include "io/truth/trajectory.hpp"
#include "tests/apps/program_run.hpp"

/// `motorcade run` over a drive with the vehicle's own motion beside it, as faulty as cheap sensors are.
namespace motorcade::test {
namespace {

using testing::HasSubstr;

const std::string kDark = "--inject black@20:49 ";

class SensedDrive : public Run {
 protected:
  static constexpr std::size_t kDarkBegin = 20, kDarkEnd = 50;  // three seconds

  RunFolder follow(const std::string& name, const std::string& options) {
    EXPECT_EQ(run(name, options), 0) << contentOf(errors());
    return readRunFolder(out(name));
  }
  /// The motion's error over the dark, as a share of the whole way.
  static double errorOverTheDark(const RunFolder& folder) {
    const std::vector<SE3> truth = readKittiPoses(std::filesystem::path(MOTORCADE_RENDERED_SEQUENCE) / "poses.txt");
    double way_m = 0;
    for (std::size_t i = 1; i < truth.size(); ++i) way_m += (truth[i - 1].inverse() * truth[i]).translation().norm();
    const auto over = [](const std::vector<SE3>& poses) { return poses[kDarkBegin - 1].inverse() * poses[kDarkEnd]; };
    return (over(truth).inverse() * over(folder.final.camera)).translation().norm() / way_m;
  }
};

TEST_F(SensedDrive, ThreeDarkSecondsCostLittleOfTheWay) {
  const RunFolder told = follow("told", kDark);
  EXPECT_LT(errorOverTheDark(told), 0.01);
  EXPECT_EQ(told.frames.back().head.segment, 0);
  const auto found = summary("told")["vehicle_motion"];
  EXPECT_NEAR(found["speed_scale"].get<double>(), 1, 0.04);
  EXPECT_EQ(found["frames_left_out"], 0);
  EXPECT_GT(errorOverTheDark(follow("untold", kDark + "--vehicle-motion none")), 0.1);
  EXPECT_FALSE(summary("untold").contains("vehicle_motion"));
}

TEST_F(SensedDrive, AnotherUnitIsToldAndCostsNothing) {
  const auto file = std::filesystem::path(out("km_h.csv"));
  std::ifstream in(std::filesystem::path(MOTORCADE_RENDERED_SEQUENCE) / "motion.csv");
  std::ofstream changed(file);
  std::string line;
  std::getline(in, line);
  changed << line << '\n';
  double time_s = 0, speed_mps = 0, yaw_rate_radps = 0;
  for (char comma = 0; in >> time_s >> comma >> speed_mps >> comma >> yaw_rate_radps;)
    changed << time_s << ',' << 3.6 * speed_mps << ',' << yaw_rate_radps << '\n';
  changed.close();
  ASSERT_EQ(run("lie", "--vehicle-motion " + file.string()), 0);
  EXPECT_THAT(contentOf(errors()), HasSubstr("km/h"));
  ASSERT_EQ(run("without", "--vehicle-motion none"), 0);
  const auto error_m = [this](const std::string& name) {
    return evaluate(name)["final"]["camera"]["ate_m"]["rmse"].get<double>();
  };
  EXPECT_LT(error_m("lie"), 1.05 * error_m("without") + 1e-4);
}

TEST_F(SensedDrive, AFileThatIsNotThereIsNamed) {
  EXPECT_EQ(run("missing", "--vehicle-motion nowhere.csv"), 3);
  EXPECT_THAT(contentOf(errors()), HasSubstr("nowhere.csv"));
}

}  // namespace
}  // namespace motorcade::test
