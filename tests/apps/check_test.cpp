#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "tests/apps/program_run.hpp"

/// `motorcade check` on the rendered drive with faults, and what `motorcade run` makes of them.
namespace motorcade::test {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class Check : public Run {
 protected:
  /// The names of what is found, and whether the exit code says that results would be worthless.
  struct Found {
    std::vector<std::string> names;
    int exit_code = 0;
  };
  Found check(const std::string& faults, const fs::path& sequence = kSequence) {
    const fs::path file = out("check.json");
    Found found;
    found.exit_code =
        motorcade("check " + sequence.string() + " --json " + file.string() + " --inject '" + faults + "'");
    const auto json = nlohmann::json::parse(contentOf(file));
    for (const auto& finding : json["findings"]) found.names.push_back(finding["name"]);
    return found;
  }
  /// A copy of the drive whose calibration tells so many times the baseline.
  fs::path withCalibration(const std::string& name, double factor_of_baseline) {
    fs::path copy = out(name);
    fs::copy(kSequence, copy, fs::copy_options::recursive);
    std::istringstream lines(contentOf(kSequence / "calib.txt"));
    std::ofstream calibration(copy / "calib.txt");
    for (std::string line; std::getline(lines, line); calibration << '\n') {
      std::istringstream fields(line);
      std::string field;
      for (int i = 0; fields >> field; ++i) {
        if (i == 4 && line.starts_with("P1:"))
          calibration << factor_of_baseline * std::stod(field) << ' ';
        else
          calibration << field << ' ';
      }
    }
    return copy;
  }
};

TEST_F(Check, IsQuietWhereNothingIsWrong) {
  const Found found = check("seed=1");
  EXPECT_THAT(found.names, IsEmpty());
  EXPECT_EQ(found.exit_code, 0);
  EXPECT_THAT(contentOf(out("stdout")), HasSubstr("nothing is wrong"));
}

TEST_F(Check, NamesWhatMakesResultsWorthless) {
  const struct {
    std::string faults, name;
  } cases[] = {{"exchanged", "exchanged"},  {"lowered=1.5/right", "rows"},
               {"lowered=4/right", "rows"}, {"lowered=-4/right", "rows"},
               {"rolled=1/right", "roll"},  {"barrel=-0.15", "distortion"},
               {"apart", "apart"}};
  for (const auto& [faults, name] : cases) {
    const Found found = check(faults);
    EXPECT_THAT(found.names, Contains(name)) << faults;
    EXPECT_EQ(found.exit_code, 3) << faults;
  }
}

TEST_F(Check, NamesWhatMakesResultsWorse) {
  const struct {
    std::string faults, name;
  } cases[] = {{"blur=9", "blur"},
               {"noise=20", "noise"},
               {"exposure=0.5@5::2", "exposure"},
               {"exposure=0.5/right", "exposure"},
               {"jump=3600@7", "times"}};
  for (const auto& [faults, name] : cases) {
    const Found found = check(faults);
    EXPECT_THAT(found.names, Contains(name)) << faults;
    EXPECT_EQ(found.exit_code, 0) << faults;
  }
}

TEST_F(Check, PassesOverPairsThatLackAnImage) {
  EXPECT_THAT(check("one_eyed@2,truncated@4,black@6").names, Not(Contains("rows")));
}

TEST_F(Check, NamesACalibrationThatCannotBe) {
  const fs::path millimeters = withCalibration("millimeters", 1000);
  const Found found = check("seed=1", millimeters);
  EXPECT_THAT(found.names, Contains("calibration"));
  EXPECT_EQ(found.exit_code, 3);
  EXPECT_EQ(run("refused", "", millimeters), 3);
  EXPECT_THAT(contentOf(errors()), HasSubstr("must be in meters"));
  EXPECT_EQ(run("forced", "--force", millimeters), 0);
}

TEST_F(Check, WritesAPageThatShowsTheWorstPairsAndSaysWhereToFindIt) {
  check("lowered=4/right");
  EXPECT_THAT(contentOf(out("stdout")), HasSubstr("--page"));
  const fs::path file = out("check.html");
  EXPECT_EQ(motorcade("check " + kSequence.string() + " --inject lowered=4/right --page " + file.string()), 3);
  EXPECT_THAT(contentOf(out("stdout")), HasSubstr(file.string()));
  const std::string page = contentOf(file);
  std::size_t pictures = 0;
  for (auto at = page.find("data:image/jpeg"); at != std::string::npos; at = page.find("data:image/jpeg", at + 1))
    ++pictures;
  EXPECT_EQ(pictures, 4U) << "three pairs and the field of row errors";
  EXPECT_THAT(page, HasSubstr("The rows of the two images do not agree"));
  EXPECT_EQ(motorcade("check " + kSequence.string() + " --page " + out("nowhere/check.html").string()), 4);
}

TEST_F(Check, SaysThatBlackImagesTellNothing) {
  const Found found = check("black");
  EXPECT_THAT(found.names, Contains("points"));
  EXPECT_EQ(found.exit_code, 0);
}

TEST_F(Check, ARunEndsWhereItsResultsWouldBeWorthless) {
  EXPECT_EQ(run("refused", "--inject lowered=4/right"), 3);
  EXPECT_THAT(contentOf(errors()), HasSubstr("rectify the images anew"));
  EXPECT_EQ(run("forced", "--force --inject lowered=4/right"), 0);
  EXPECT_THAT(contentOf(errors()), HasSubstr("rectify the images anew"));
  EXPECT_EQ(summary("forced")["frames"]["processed"], kFrames);
}

}  // namespace
}  // namespace motorcade::test
