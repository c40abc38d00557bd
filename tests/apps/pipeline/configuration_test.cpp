#include "apps/pipeline/configuration.hpp"

#include <limits>
#include <numeric>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/files/errors.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using test::contentOf;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

std::string complaintAbout(const std::string& toml) {
  PipelineConfig config;
  try {
    applyToml(config, toml, "drive.toml");
  } catch (const UsageError& error) {
    EXPECT_EQ(error.exitCode(), 2);
    return error.what();
  }
  return "no complaint";
}

TEST(Configuration, SetsWhatTheFileNamesAndLeavesTheRest) {
  PipelineConfig config;
  applyToml(config, R"(
    backend.kind = "filter"
    [pipeline]
    frames_in_flight = 6
    [frontend]
    detector = "sift"
    [frontend.optical_flow]
    max_flow_px = 99
  )",
            "drive.toml");
  EXPECT_EQ(config.backend.kind, BackendKind::kFilter);
  EXPECT_EQ(config.pipeline.frames_in_flight, 6);
  EXPECT_EQ(config.preparation.detector, DetectorKind::kSift);
  EXPECT_EQ(config.optical_flow.max_flow_px, 99.0);
  EXPECT_EQ(config.pipeline.threads, PipelineParams{}.threads);
}

TEST(Configuration, AcceptsTheShortFormOfTheBackendsKind) {
  PipelineConfig config;
  applyToml(config, R"(backend = "filter")", "drive.toml");
  EXPECT_EQ(config.backend.kind, BackendKind::kFilter);
}

TEST(Configuration, ReadsBackWhatItWrites) {
  PipelineConfig config;
  // Every parameter gets another value than its default, within its range.
  for (const auto& [section, parameter] : parameterTable(config)) {
    const auto [least, most] = parameter.range;
    if (const auto* number = std::get_if<int*>(&parameter.value)) **number += **number < most ? 1 : -1;
    if (const auto* number = std::get_if<double*>(&parameter.value))
      **number = std::midpoint(**number, **number < most ? most : least);
    if (const auto* flag = std::get_if<bool*>(&parameter.value)) **flag = !**flag;
    if (const auto* choice = std::get_if<Choice>(&parameter.value))
      choice->set((choice->get() + 1) % choice->names.size());
  }
  const std::string text = toToml(config);
  PipelineConfig read;
  ASSERT_NE(toToml(read), text);
  applyToml(read, text, "effective_config.toml");
  EXPECT_EQ(toToml(read), text);
}

TEST(Configuration, BindsEachKeyOnceWithItsDefaultInRange) {
  PipelineConfig config;
  // TOML itself refuses a key or section that comes twice.
  EXPECT_NO_THROW(applyToml(config, toToml(config), "defaults"));
}

TEST(Configuration, DocumentsListTheDefaults) {
  EXPECT_EQ(contentOf(MOTORCADE_SOURCE_DIR "/docs/parameters.toml"), toToml({}))
      << "docs/parameters.toml is effective_config.toml of a run without options";
}

TEST(Configuration, HasFewKeysThatEachSayWhatTheyAreFor) {
  PipelineConfig config;
  const auto table = parameterTable(config);
  EXPECT_LE(table.size(), 66U);
  for (const auto& known : table) EXPECT_GT(known.parameter.gain.size(), 10U) << known.key();
}

TEST(Configuration, NoRangeReachesInfiniteHugeOrDenormalValues) {
  PipelineConfig config;
  for (const auto& known : parameterTable(config)) {
    if (!std::holds_alternative<double*>(known.parameter.value)) continue;
    for (const double value :
         {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
          std::numeric_limits<double>::quiet_NaN(), 1e300, -1e300, std::numeric_limits<double>::denorm_min()})
      EXPECT_FALSE(known.parameter.accepts(value)) << known.key() << " accepts " << value;
  }
}

TEST(Configuration, NamesFileLineAndNearestKeyOfAnUnknownOne) {
  EXPECT_THAT(complaintAbout("[frontend.optical_flow]\nmax_track = 5\n"),
              AllOf(HasSubstr("drive.toml, line 2"), HasSubstr("'frontend.optical_flow.max_track'"),
                    HasSubstr("did you mean 'frontend.optical_flow.max_tracks'?")));
  EXPECT_THAT(complaintAbout("max_tracks = 5"), HasSubstr("did you mean 'frontend.optical_flow.max_tracks'?"));
}

TEST(Configuration, NamesTheRangeOfABadValue) {
  EXPECT_THAT(
      complaintAbout("pipeline.frames_in_flight = 0"),
      AllOf(HasSubstr("drive.toml, line 1"), HasSubstr("'pipeline.frames_in_flight' is 0"), HasSubstr("1 to 64")));
  EXPECT_THAT(complaintAbout("pipeline.threads = 1.5"), HasSubstr("a whole number, 1 to 64"));
  EXPECT_THAT(complaintAbout("frontend.detector = \"orb\""), HasSubstr("\"corners\" or \"sift\""));
  EXPECT_THAT(complaintAbout("frontend.optical_flow.max_flow_px = nan"), HasSubstr("20 to 1000"));
  EXPECT_THAT(complaintAbout("backend.factors.use_motion = 1"), HasSubstr("true or false"));
}

TEST(Configuration, NamesTheLineThatIsNoToml) {
  EXPECT_THAT(complaintAbout("[pipeline]\nthreads = = 2"), HasSubstr("drive.toml, line 2"));
}

TEST(Configuration, RefusesWhatTheParserCannotStand) {
  for (const char* header : {"[+x]", "[= 1", "[[ \t", "  [\x01"})
    EXPECT_THAT(complaintAbout(std::string("\n") + header + "\n"),
                HasSubstr("drive.toml, line 2: a section's name must begin with a letter"));
  EXPECT_THAT(complaintAbout("\n\u043f = 1\n"), HasSubstr("drive.toml, line 2: has a letter that is not ASCII"));
  EXPECT_THAT(complaintAbout("\xEF\xBB\xBFpipeline.threads = 1  # \u043f ............\n"), HasSubstr("no complaint"));
  EXPECT_THAT(complaintAbout("a = 1\nb = 1979-05-27T:07-+\nc = 2\n"), HasSubstr("drive.toml, line 2: is no TOML"));
  std::string deep;
  for (int i = 0; i < 100'000; ++i) deep += "a.";  // a table each, taken apart one in the other
  EXPECT_THAT(complaintAbout("\n" + deep + "a = 1\n"), HasSubstr("drive.toml, line 2: has more than 100 dots"));
  EXPECT_THAT(complaintAbout("a = {\n" + deep), HasSubstr("line"));
}

TEST(Configuration, ShowsNoByteThatATerminalTakesForACommandAndNoLongText) {
  EXPECT_THAT(complaintAbout("\"\\u001b[2J\" = 1\n"),
              AllOf(HasSubstr("line 1: unknown key '?"), Not(HasSubstr("\x1b"))));
  EXPECT_THAT(complaintAbout("pipeline.threads = \"\\u001b[2J\"\n"), Not(HasSubstr("\x1b")));
  EXPECT_LT(complaintAbout(std::string(100'000, 'k') + " = 1\n").size(), 300u);
  EXPECT_LT(complaintAbout("pipeline.threads = \"" + std::string(100'000, 'v') + "\"\n").size(), 300u);
}

TEST(Configuration, TakesSingleAssignments) {
  PipelineConfig config;
  applyAssignment(config, "pipeline.threads=1");
  applyAssignment(config, "frontend.detector=sift");
  applyAssignment(config, "backend=\"filter\"");
  EXPECT_EQ(config.pipeline.threads, 1);
  EXPECT_EQ(config.preparation.detector, DetectorKind::kSift);
  EXPECT_EQ(config.backend.kind, BackendKind::kFilter);
  EXPECT_THROW(applyAssignment(config, "pipeline.threads"), UsageError);
  EXPECT_THROW(applyAssignment(config, "pipeline.thread=1"), UsageError);
  EXPECT_THROW(applyAssignment(config, "pipeline.threads=[1]"), UsageError);
}

TEST(Configuration, ComplainsAboutAFileThatIsNotThere) {
  PipelineConfig config;
  EXPECT_THROW(applyFile(config, "no/such/file.toml"), UsageError);
}

}  // namespace
}  // namespace motorcade
