#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/apps/program_run.hpp"

/// Tests the program's answers to its command line, before it does anything.
namespace motorcade::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string words(const std::vector<std::string>& arguments) {
  std::string line;
  for (const std::string& argument : arguments) line.append(argument).append(" ");
  return line;
}

class CommandLine : public Run {
 protected:
  /// Runs the program, which must end so, and returns the text of both outputs.
  std::string said(const std::string& arguments, int exit_code, const std::string& prefix = "") {
    EXPECT_EQ(motorcade(arguments, prefix), exit_code) << arguments;
    return contentOf(out("stdout")) + contentOf(errors());
  }

  /// All commands, as the program's help lists them; `bridge` is not in every build.
  std::vector<std::string> commands() {
    std::istringstream help(said("--help", 0));
    std::vector<std::string> names;
    std::string line;
    while (std::getline(help, line) && line != "Subcommands:") continue;
    while (std::getline(help, line))
      if (line.starts_with("  ") && line[2] != ' ') names.push_back(line.substr(2, line.find(' ', 2) - 2));
    EXPECT_THAT(names, testing::IsSupersetOf({"run", "check", "synth", "evaluate", "draw", "report", "latency",
                                              "export", "view", "solve", "batch", "help"}));
    return names;
  }
};

TEST_F(CommandLine, HelpIsWhatTheHelpOptionSays) {
  EXPECT_EQ(said("help", 0), said("--help", 0));
  EXPECT_THAT(said("help", 0), AllOf(HasSubstr("Usage: motorcade"), HasSubstr("evaluate")));
  for (const std::string& command : commands()) EXPECT_EQ(said("help " + command, 0), said(command + " --help", 0));
  EXPECT_THAT(said("help draw", 0), AllOf(HasSubstr("Usage: motorcade draw"), HasSubstr("--every")));
}

TEST_F(CommandLine, HelpOfEachCommandEndsWithExamples) {
  for (const std::string& command : commands()) {
    const std::string help = said(command + " --help", 0);
    const auto begin = help.rfind("\nExample");
    ASSERT_NE(begin, std::string::npos) << command;
    std::istringstream examples(help.substr(begin + 1));
    for (std::string line; std::getline(examples, line);) EXPECT_THAT(line, HasSubstr(" motorcade " + command + " "));
  }
}

TEST_F(CommandLine, NamesWhatWasLikelyMeant) {
  EXPECT_THAT(said("run x --out y --thread 2", 2), HasSubstr("unknown option --thread; did you mean --threads?"));
  EXPECT_THAT(said("run x --out y --thread=2", 2), HasSubstr("unknown option --thread; did you mean --threads?"));
  EXPECT_THAT(said("run x --ou y", 2), HasSubstr("unknown option --ou; did you mean --out?"));
  EXPECT_THAT(said("--verson", 2), HasSubstr("unknown option --verson; did you mean --version?"));
  EXPECT_THAT(said("evalaute x", 2), HasSubstr("unknown command evalaute; did you mean evaluate?"));
  EXPECT_THAT(said("evalaute --help", 2), HasSubstr("did you mean evaluate?"));
  EXPECT_THAT(said("help evalaute", 2), HasSubstr("did you mean evaluate?"));
  EXPECT_THAT(said("--threads 2 run x --out y", 2), HasSubstr("--threads must stand behind the command's name"));
  EXPECT_THAT(said("run x --out y --zebra", 2),
              AllOf(HasSubstr("unknown option --zebra\n"), Not(HasSubstr("did you mean"))));
}

TEST_F(CommandLine, SaysWhatIsMissing) {
  EXPECT_THAT(said("run x", 2), HasSubstr("--out is required"));
  EXPECT_THAT(said("run --out y", 2), HasSubstr("SEQUENCE is required"));
  EXPECT_THAT(said("run x y --out z", 2), HasSubstr("unexpected argument y"));
}

TEST_F(CommandLine, TheVersionTellsHowItWasBuiltAndOfWhat) {
  const std::string version = said("--version", 0);
  EXPECT_EQ(version.find("motorcade 0."), 0U);
  for (const char* const part :
       {"build", "compiler", "instruction_set", "onetbb", "eigen", "opencv", "libpng", "jpeg", "cli11", "spdlog"})
    EXPECT_THAT(version, HasSubstr(part));
  EXPECT_THAT(version, testing::ContainsRegex("instruction_set +(AVX512|AVX2|SSE4|SSE2|NEON|any)\n"));
}

TEST_F(CommandLine, TheSummaryHasTheSameVersions) {
  ASSERT_EQ(run("out", "--frames 0:2"), 0) << contentOf(errors());
  const std::string version = said("--version", 0);
  const auto json = summary("out")["versions"];
  EXPECT_GE(json.size(), 10U);
  for (const auto& [name, value] : json.items()) {
    EXPECT_THAT(version, HasSubstr(name));
    EXPECT_THAT(version, HasSubstr(value.get<std::string>())) << name;
  }
}

TEST_F(CommandLine, TheLogIsAsTalkativeAsAskedForBeforeAndBehindTheCommand) {
  const std::string two_frames = kSequence.string() + " --frames 0:2 --force --out " + out("out").string();
  EXPECT_THAT(said("run " + two_frames, 0),
              AllOf(HasSubstr(" info "), HasSubstr("throughput"), Not(HasSubstr("debug"))));
  for (const std::string quiet : {"-q", "--quiet", "--log-level warning", "--log-level off"}) {
    EXPECT_EQ(said(words({"run", two_frames, quiet}), 0), "") << quiet;
    EXPECT_EQ(said(words({quiet, "run", two_frames}), 0), "") << quiet;
  }
  for (const std::string verbose : {"-v", "--verbose", "--log-level debug", "--log-level trace"}) {
    EXPECT_THAT(said(words({"run", two_frames, verbose}), 0), HasSubstr(" debug ")) << verbose;
    EXPECT_THAT(said(words({verbose, "run", two_frames}), 0), HasSubstr(" debug ")) << verbose;
  }
  const std::string nowhere = "run " + out("nowhere").string() + " --out " + out("x").string();
  EXPECT_THAT(said("-q " + nowhere, 3), HasSubstr("nowhere"));
  EXPECT_EQ(said("--log-level off " + nowhere, 3), "");
  EXPECT_THAT(said("--log-level loud " + nowhere, 2), HasSubstr("loud not in"));
  EXPECT_THAT(said("-q " + nowhere + " -v", 2), HasSubstr("give one of --quiet, --verbose and --log-level"));
}

/// `script` (of util-linux) gives the program a terminal.
TEST_F(CommandLine, ColorsAreForTerminalsAndNotWhereTheUserWantsNone) {
  const std::string failing = "run " + out("nowhere").string() + " --out " + out("x").string(), escape = "\033[";
  EXPECT_THAT(said(failing, 3, "TERM=xterm "), Not(HasSubstr(escape)));
  if (std::system("script -qec true /dev/null >/dev/null 2>&1") != 0) GTEST_SKIP() << "there is no program script";
  const auto on_terminal = [&](const std::string& environment) {
    const std::string command = "env " + environment + " TERM=xterm script -qec '" MOTORCADE_PROGRAM " " + failing +
                                "' /dev/null >" + out("terminal").string() + " 2>&1 </dev/null";
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 3);
    return contentOf(out("terminal"));
  };
  EXPECT_THAT(on_terminal("-u NO_COLOR"), HasSubstr(escape));
  EXPECT_THAT(on_terminal("NO_COLOR="), HasSubstr(escape)) << "empty is as if it were not there";
  EXPECT_THAT(on_terminal("NO_COLOR=1"), AllOf(HasSubstr("nowhere"), Not(HasSubstr(escape))));
}

}  // namespace
}  // namespace motorcade::test
