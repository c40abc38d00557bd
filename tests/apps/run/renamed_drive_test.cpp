#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>

#include <gmock/gmock.h>

#include "io/layouts/open_sequence.hpp"
#include "io/results/run_folder.hpp"
#include "io/sequence/sequence.hpp"
#include "tests/apps/program_run.hpp"

/// Runs of drives whose images have other names, or are missing.
namespace motorcade::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Names with numbers of four digits.
std::function<std::string(std::size_t)> padded(const std::string& before) {
  return [before](std::size_t i) {
    std::string digits = std::to_string(i);
    return before + std::string(4 - digits.size(), '0') + digits + ".png";
  };
}

/// The rendered drive under other names, in folders left and right.
class RenamedDrive : public Run {
 protected:
  using NameOf = std::function<std::string(std::size_t)>;

  fs::path drive() const { return out("drive with blanks"); }
  void link(StereoSide side, const NameOf& nameOf, const std::vector<std::size_t>& missing = {}) const {
    const Sequence rendered = openSequence(kSequence);
    const fs::path folder = drive() / (side == StereoSide::kLeft ? "left" : "right");
    fs::create_directories(folder);
    for (std::size_t i = 0; i < rendered.frames.size(); ++i)
      if (std::ranges::find(missing, i) == missing.end())
        fs::create_symlink(fs::absolute(rendered.frames[i].of(side)), folder / nameOf(i));
    if (!fs::exists(drive() / "calib.txt")) fs::copy(kSequence / "calib.txt", drive() / "calib.txt");
  }
  void copyTruth(const std::string& file) const { fs::copy(kSequence / file, drive() / file); }
  std::string quoted() const { return "'" + drive().string() + "'"; }
  int runDrive(const std::string& name, const std::string& options = "") {
    return motorcade("run " + quoted() + " --out " + out(name).string() + " " + options);
  }
  double ate_m(const std::string& name, const std::string& sequence) {
    EXPECT_EQ(motorcade("evaluate " + out(name).string() + " --sequence " + sequence + " --json " +
                        out(name + ".json").string()),
              0)
        << contentOf(errors());
    return nlohmann::json::parse(contentOf(out(name + ".json")))["final"]["camera"]["ate_m"]["rmse"].get<double>();
  }
};

TEST_F(RenamedDrive, ImagesMissingOnEachSideCostTheirFramesAndNothingElse) {
  link(StereoSide::kLeft, padded("left"), {5});
  link(StereoSide::kRight, padded("right"), {9});
  for (const char* file : {"poses.txt", "times.txt"}) copyTruth(file);
  EXPECT_EQ(motorcade("check " + quoted()), 0) << contentOf(out("stdout"));
  EXPECT_THAT(contentOf(out("stdout")),
              AllOf(HasSubstr("warning (pairs)"), HasSubstr("left/left0005.png"), HasSubstr("right/right0009.png")));
  ASSERT_EQ(runDrive("missing"), 0) << contentOf(errors());
  EXPECT_THAT(contentOf(errors()), AllOf(HasSubstr("1 left missing"), HasSubstr("left0005.png: is missing")));
  const auto images = summary("missing")["images"];
  EXPECT_EQ(images["pairs"], kFrames - 2);
  EXPECT_EQ(images["left_missing"], 1);
  EXPECT_EQ(images["right_missing"], 1);
  EXPECT_EQ(summary("missing")["frames"]["rejected"], 2);
  ASSERT_EQ(run("dropped", "--inject drop@5,drop@9"), 0) << contentOf(errors());
  const double missing_m = ate_m("missing", quoted()), dropped_m = ate_m("dropped", kSequence.string());
  EXPECT_NEAR(missing_m, dropped_m, 0.1 * dropped_m + 0.002);  // the same pairs, in other ways of passing over
}

TEST_F(RenamedDrive, NumbersWithoutZerosAheadGiveTheSameBytes) {
  const auto plain = [](std::size_t i) { return "img" + std::to_string(i) + ".png"; };
  link(StereoSide::kLeft, plain);
  link(StereoSide::kRight, plain);
  copyTruth("times.txt");
  ASSERT_EQ(runDrive("plain"), 0) << contentOf(errors());
  EXPECT_THAT(contentOf(errors()), Not(HasSubstr("warning")));
  ASSERT_EQ(run("folder"), 0) << contentOf(errors());
  expectSame("plain", "folder");
}

TEST_F(RenamedDrive, TimesInTheNamesAreThoseOfTheFrames) {
  const auto named = [](std::int64_t later_ns) {
    return [=](std::size_t i) {
      return std::to_string(1'403'636'579'763'555'584 + 33'333'333 * static_cast<std::int64_t>(i) + later_ns) + ".png";
    };
  };
  link(StereoSide::kLeft, named(0));
  link(StereoSide::kRight, named(1'234));
  ASSERT_EQ(runDrive("times"), 0) << contentOf(errors());
  EXPECT_NEAR(summary("times")["capture_rate_hz"].get<double>(), 30, 1e-3);
  EXPECT_THAT(contentOf(errors()), Not(HasSubstr("has no times")));
}

TEST_F(RenamedDrive, AListThatNamesMissingFilesOrMixesNumbersIsTold) {
  link(StereoSide::kLeft, padded("left"), {7});
  link(StereoSide::kRight, padded("right"));
  const auto writeList = [this](bool shifted) {
    std::ofstream list(drive() / "list.txt");
    for (std::size_t i = 0; i < kFrames; ++i)
      if (!shifted || i + 1 < kFrames)
        list << "left/" << padded("left")(shifted && i >= 7 ? i + 1 : i) << ",right/" << padded("right")(i) << '\n';
  };
  const std::string list = "'" + (drive() / "list.txt").string() + "'";
  writeList(false);
  EXPECT_EQ(motorcade("check " + list), 0) << contentOf(errors());
  EXPECT_THAT(contentOf(out("stdout")), AllOf(HasSubstr("warning (pairs)"), HasSubstr("left/left0007.png")));
  EXPECT_EQ(motorcade("run " + list + " --out " + out("list").string()), 0) << contentOf(errors());
  EXPECT_EQ(summary("list")["images"]["left_missing"], 1);
  writeList(true);
  EXPECT_EQ(motorcade("check " + list), 3);
  EXPECT_EQ(motorcade("run " + list + " --out " + out("shifted").string()), 3);
  EXPECT_THAT(contentOf(errors()), HasSubstr("different numbers"));
}

/// The commands of the message, as a shell takes them.
std::string commandsIn(const std::string& message) {
  std::string commands;
  std::istringstream lines(message);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("  ") && !line.starts_with("  motorcade")) commands += line + "\n";
  return commands;
}

TEST_F(RenamedDrive, ImagesInOneFolderBecomeASequenceByTheCommandsOfTheMessage) {
  link(StereoSide::kLeft, padded("left it's "), {7});
  fs::rename(drive() / "left", drive() / "all");
  link(StereoSide::kRight, padded("right"));
  for (const auto& entry : fs::directory_iterator(drive() / "right"))
    fs::rename(entry, drive() / "all" / entry.path().filename());
  fs::remove(drive() / "right");
  const std::string here = "cd '" + out("").string() + "' && ";
  EXPECT_EQ(motorcade("run '" + (drive() / "all").string() + "' --out " + out("one").string()), 3);
  const std::string commands = commandsIn(contentOf(errors()));
  ASSERT_EQ(std::system((here + "set -e\n" + commands).c_str()), 0) << commands;
  fs::copy(kSequence / "calib.txt", out("DRIVE") / "calib.txt");
  EXPECT_EQ(motorcade("run " + out("DRIVE").string() + " --out " + out("one").string()), 0) << contentOf(errors());
  EXPECT_EQ(summary("one")["images"]["pairs"], kFrames - 1);
}

}  // namespace
}  // namespace motorcade::test
