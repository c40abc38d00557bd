#include <cstdlib>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "tests/apps/program_run.hpp"
#include "tests/support/data_folder.hpp"

/// Compares `motorcade check` on the rendered drive with faults with `motorcade run` on it.
namespace motorcade::test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class Check : public Run {
 protected:
  /// Names of the findings, and whether the exit code says that results would be worthless.
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
  /// A copy of the drive whose calibration states so many times the baseline.
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

TEST_F(Check, SaysThatBlackOrMissingImagesTellNothing) {
  const Found black = check("black");
  EXPECT_THAT(black.names, ElementsAre("points"));
  EXPECT_EQ(black.exit_code, 3);
  EXPECT_THAT(contentOf(out("stdout")), HasSubstr("it finds nothing to follow"));
  const Found truncated = check("truncated");
  EXPECT_THAT(truncated.names, ElementsAre("images"));
  EXPECT_EQ(truncated.exit_code, 3);
  EXPECT_THAT(contentOf(out("stdout")), HasSubstr("none of 14 pairs can be used: "));
  EXPECT_THAT(contentOf(out("stdout")), HasSubstr("000000.png"));
}

/// Same evidence, same findings, same exit code for each kind of fault: at its default strength and weaker, over the
/// whole drive and in single frames.
TEST_F(Check, AndRunAgreeOnEveryFault) {
  for (const std::string faults : {"drop",
                                   "drop@::3",
                                   "duplicate@::2",
                                   "late=3",
                                   "reordered",
                                   "black",
                                   "black@0:5",
                                   "black/right",
                                   "white",
                                   "blur",
                                   "blur=31",
                                   "noise",
                                   "noise=200",
                                   "exposure",
                                   "exposure=0.2/right",
                                   "jpeg",
                                   "jpeg=1",
                                   "truncated",
                                   "truncated~0.3",
                                   "bitflips",
                                   "exchanged",
                                   "exchanged@4",
                                   "apart",
                                   "apart=2",
                                   "apart@3:6",
                                   "lowered=1/right",
                                   "lowered=1.5/right",
                                   "lowered/right",
                                   "rolled=0.1/right",
                                   "rolled/right",
                                   "zoomed/right",
                                   "zoomed=3/right",
                                   "barrel",
                                   "one_eyed",
                                   "one_eyed@::2",
                                   "stall=0.01@2",
                                   "jump",
                                   "jump=-3600@4"}) {
    SCOPED_TRACE(faults);
    const Found found = check(faults);
    EXPECT_EQ(run("agree", "--inject '" + faults + "'"), found.exit_code) << contentOf(errors());
    std::vector<std::string> of_run;
    const auto json = summary("agree");
    for (const auto& finding : json["findings"]) of_run.push_back(finding["name"]);
    const bool nothing_came = found.names == std::vector<std::string>{"images"};  // which a run tells at its end
    EXPECT_TRUE(nothing_came || of_run == found.names);
    fs::remove_all(out("agree"));
  }
}

/// Kinds of folders that people have.
TEST_F(Check, AndRunAgreeOnCasesFromTheField) {
  const fs::path maker = test::dataFolder().parent_path() / "cases" / "make.py";
  const fs::path cases = out("cases");
  if (!fs::exists(maker)) GTEST_SKIP() << maker << " is not there";
  if (std::system(("PATH=/usr/bin:$PATH python3 " + maker.string() + " " + kSequence.string() + " " + cases.string() +
                   " --frames 14 >/dev/null 2>&1")
                      .c_str()) != 0)
    GTEST_SKIP() << "needs Python with numpy";
  std::vector<fs::path> drives;
  for (const auto& entry : fs::directory_iterator(cases)) drives.push_back(entry.path());
  ASSERT_GE(drives.size(), 7U);
  for (const fs::path& drive : drives)
    EXPECT_EQ(run(drive.filename().string(), "", drive), check("seed=1", drive).exit_code)
        << drive << contentOf(errors());
}

TEST_F(Check, ARunEndsWithinTwentyPairsOfAChangeOfTheRig) {
  const fs::path drive = test::dataFolder() / "kitti_tracking_0003";
  if (!fs::exists(drive)) GTEST_SKIP() << drive << " is not there";
  const struct {
    std::string faults, name;
  } cases[] = {{"exchanged@30:", "exchanged"}, {"apart@30:", "apart"}, {"lowered=2/right@30:", "rows"}};
  for (const auto& [faults, name] : cases)
    for (const std::string pace : {"", " --live --rate 20"}) {
      SCOPED_TRACE(faults + pace);
      EXPECT_EQ(run("changed", "--frames 0:60 --inject " + faults + pace, drive), 3);
      EXPECT_THAT(contentOf(errors()), HasSubstr("the pairs changed: "));
      const auto json = summary("changed");
      EXPECT_EQ(json["complete"], false);
      EXPECT_TRUE(!pace.empty() || json["frames"]["received"] <= 50);
      ASSERT_EQ(json["findings"].size(), 1U);
      EXPECT_EQ(json["findings"][0]["name"], name);
      EXPECT_LT(json["findings"][0]["last_good_frame"], 30);
      EXPECT_GE(json["findings"][0]["first_bad_frame"], 30);
    }
  EXPECT_EQ(run("forced", "--force --frames 0:60 --inject exchanged@30:", drive), 0);
  EXPECT_EQ(summary("forced")["frames"]["received"], 60);
  EXPECT_EQ(summary("forced")["findings"].size(), 1U);
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
