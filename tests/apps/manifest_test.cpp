#include "apps/tasks/manifest.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/tasks/found_drives.hpp"
#include "io/errors.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class ManifestFile : public testing::Test {
 protected:
  Manifest read(const std::string& text, const std::string& name = "m.toml") {
    std::ofstream(folder_ / name) << text;
    return readManifest(folder_ / name);
  }
  std::string complaintAbout(const std::string& text, const std::string& name = "m.toml") {
    try {
      read(text, name);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "none";
  }

  const test::TemporaryFolder folder_;
};

TEST_F(ManifestFile, DefaultsStandBehindWhatADriveSays) {
  const Manifest manifest = read(R"(
root = "drives"
[defaults]
masks = true
repetitions = 2
[[drives]]
path = "a"
[[drives]]
path = "b"
masks = false
fps = 12.5
)");
  EXPECT_EQ(manifest.root, folder_ / "drives");
  ASSERT_EQ(manifest.entries.size(), 2U);
  EXPECT_EQ(manifest.entries[0].options.at("masks"), "true");
  EXPECT_EQ(manifest.entries[1].options.at("masks"), "false");
  EXPECT_EQ(manifest.entries[1].options.at("fps"), "12.5");
  EXPECT_EQ(manifest.entries[1].repetitions, 2);
  ASSERT_EQ(manifest.sets.size(), 1U);
  EXPECT_EQ(manifest.sets[0].name, "default");
}

TEST_F(ManifestFile, SetsKeepTheOrderOfTheFile) {
  const Manifest manifest = read(R"(
baseline_set = "a"
[sets.z]
[sets.a]
backend.kind = "filter"
pipeline.frames_in_flight = 3
[[drives]]
path = "x"
)");
  ASSERT_EQ(manifest.sets.size(), 2U);
  EXPECT_EQ(manifest.sets[0].name, "z");
  EXPECT_THAT(manifest.sets[1].assignments, ElementsAre("backend.kind=filter", "pipeline.frames_in_flight=3"));
}

TEST_F(ManifestFile, SeedsAreNumbersAndRanges) {
  const auto seeds = [&](const std::string& text) {
    return read("[[drives]]\nscene = \"lead\"\nseeds = " + text).entries[0].seeds;
  };
  EXPECT_THAT(seeds("[3, 1]"), ElementsAre(1, 3));
  EXPECT_THAT(seeds("\"2-4\""), ElementsAre(2, 3, 4));
  EXPECT_THAT(seeds("[7, \"1-2\"]"), ElementsAre(1, 2, 7));
}

TEST_F(ManifestFile, ATableHasARowForEachDriveAndParametersByTheirNames) {
  const Manifest manifest = read(
      "path,name,seeds,inject,set,backend.kind\n"
      "a/b,one,,,joint,joint\n"
      "\"a,c\",two,1-2 5,noise=20,plain,\n"
      "# not this one\n"
      "d,three,,,joint,joint\n",
      "m.csv");
  ASSERT_EQ(manifest.entries.size(), 3U);
  EXPECT_EQ(manifest.entries[1].path, "a,c");
  EXPECT_THAT(manifest.entries[1].seeds, ElementsAre(1, 2, 5));
  EXPECT_THAT(manifest.entries[2].sets, ElementsAre("joint"));
  ASSERT_EQ(manifest.sets.size(), 2U);
  EXPECT_THAT(manifest.sets[0].assignments, ElementsAre("backend.kind=joint"));
  EXPECT_TRUE(manifest.sets[1].assignments.empty());
}

TEST_F(ManifestFile, FaultsAreNamedWithTheirLineAndHowToMendThem) {
  EXPECT_THAT(complaintAbout("[[drives]]\npath = \"a\"\nrepetition = 3\n"),
              testing::AllOf(HasSubstr("m.toml, line 1"), HasSubstr("did you mean 'repetitions'?")));
  EXPECT_THAT(complaintAbout("[[drives]]\nscene = \"lead\"\npath = \"a\"\n"), HasSubstr("either 'path'"));
  EXPECT_THAT(complaintAbout("[[drives]]\npath = \"a\"\nseeds = [1]\n"), HasSubstr("'repetitions'"));
  EXPECT_THAT(complaintAbout("[[drives]]\npath = \"a\"\nsets = [\"x\"]\n"), HasSubstr("there is no [sets.x]"));
  EXPECT_THAT(complaintAbout("[[drives]]\npath = \"a\"\nmasks = \"yes\"\n"), HasSubstr("true or false"));
  EXPECT_THAT(complaintAbout("drives = 3\n"), HasSubstr("[[drives]]"));
  EXPECT_THAT(complaintAbout("root = \"a\"\n"), HasSubstr("has no drives"));
  EXPECT_THAT(complaintAbout("[[drives]\n"), HasSubstr("is no TOML"));
  EXPECT_THAT(complaintAbout("path,name\na\n", "m.csv"), HasSubstr("m.csv, line 2: has 1 fields"));
  EXPECT_THAT(complaintAbout("path,name\n\"a,b\n", "m.csv"), HasSubstr("a quote is not closed"));
  EXPECT_THAT(complaintAbout("path,set,a.b\nx,s,1\ny,s,2\n", "m.csv"), HasSubstr("line 3: set 's' has other"));
  EXPECT_THAT(complaintAbout("[[drives]]\npath = \"a\"\nname = \"a/b\"\n"), HasSubstr("is no name"));
  EXPECT_THAT(complaintAbout("[[drives]]\nscene = \"lead\"\nseeds = \"5-2\"\n"), HasSubstr("as 1-5"));
}

TEST_F(ManifestFile, AGlobBecomesADriveForEachFolderNamedFromItsWildcardOn) {
  for (const char* const name : {"fleet/a/mav0", "fleet/b.c/mav0", "fleet/empty"})
    fs::create_directories(folder_ / name);
  std::ofstream(folder_ / "fleet/file") << "no folder\n";
  std::ofstream(folder_ / "fleet/list.txt") << "left right\n";
  std::vector<std::string> names;
  for (const FoundDrive& drive : findDrives({.path = "fleet/*/mav0"}, folder_.path())) names.push_back(drive.name);
  EXPECT_THAT(names, ElementsAre("a_mav0", "b_c_mav0"));
  names.clear();
  for (const FoundDrive& drive : findDrives({.path = "fleet/*"}, folder_.path())) names.push_back(drive.name);
  EXPECT_THAT(names, ElementsAre("a", "b_c", "empty"));
  const auto lists = findDrives({.path = "fleet/*.txt"}, folder_.path());
  ASSERT_EQ(lists.size(), 1U);
  EXPECT_EQ(lists[0].name, "list");
}

TEST_F(ManifestFile, WhatIsNotThereIsADriveWithAProblem) {
  const auto missing = findDrives({.path = "nowhere/"}, folder_.path());
  ASSERT_EQ(missing.size(), 1U);
  EXPECT_EQ(missing[0].name, "nowhere");
  EXPECT_THAT(missing[0].problem, HasSubstr("there is no such drive"));
  const auto none = findDrives({.path = "no*where"}, folder_.path());
  ASSERT_EQ(none.size(), 1U);
  EXPECT_EQ(none[0].name, "no_where");
  EXPECT_THAT(none[0].problem, HasSubstr("no folder matches"));
}

}  // namespace
}  // namespace motorcade
