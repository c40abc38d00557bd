#include <string>

#include <gmock/gmock.h>

#include "tests/apps/program_run.hpp"

/// Cameras that shake against each other.
namespace motorcade::test {
namespace {

using testing::HasSubstr;
using testing::Not;

class Shake : public Run {
 protected:
  fs::path drive(const std::string& name, const std::string& options) {
    EXPECT_EQ(motorcade("synth " + out(name).string() + " --scene static --frames 40 --size 621x188 " + options), 0)
        << contentOf(errors());
    return out(name);
  }
  double found_px(const std::string& name) const { return summary(name)["solver"]["disparity_shake_px"]; }
  std::string told() const { return contentOf(out("stdout")); }
  std::string page(const std::string& name) {
    EXPECT_EQ(motorcade("report " + out(name).string()), 0);
    return contentOf(out(name) / "report.html");
  }
};

TEST_F(Shake, IsFoundAndTold) {
  constexpr double kShake_px = 0.1;
  ASSERT_EQ(run("shaken", "", drive("shaking", "--shake 0.1")), 0) << contentOf(errors());
  EXPECT_NEAR(found_px("shaken"), kShake_px, 0.3 * kShake_px);
  EXPECT_THAT(told(), HasSubstr("cameras     shake by 0."));
  EXPECT_NE(page("shaken").find("shake of the cameras"), std::string::npos);
}

TEST_F(Shake, ThatIsNotThereIsNotTold) {
  ASSERT_EQ(run("still", "", drive("rigid", "")), 0) << contentOf(errors());
  EXPECT_LT(found_px("still"), 0.01);
  EXPECT_THAT(told(), Not(HasSubstr("shake")));
  EXPECT_EQ(page("still").find("shake of the cameras"), std::string::npos);
}

}  // namespace
}  // namespace motorcade::test
