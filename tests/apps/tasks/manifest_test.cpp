#include "apps/tasks/manifest.hpp"

#include <cstdlib>
#include <fstream>
#include <set>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/tasks/plan.hpp"
#include "apps/tasks/planned_drive.hpp"
#include "io/files/errors.hpp"
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
  EXPECT_THAT(complaintAbout("[[drives]]\npath = \"a\"\nshake = 0.03\n"), HasSubstr("for scenes"));
  EXPECT_THAT(complaintAbout("[[drives]]\nscene = \"lead\"\nshake = \"much\"\n"), HasSubstr("a number above 0"));
  EXPECT_THAT(complaintAbout("drives = 3\n"), HasSubstr("[[drives]]"));
  EXPECT_THAT(complaintAbout("\n[[drives]]\nckend.kind = \"joint\"\n"),
              testing::AllOf(HasSubstr("m.toml, line 3"), HasSubstr("[sets.NAME]")));
  EXPECT_THAT(complaintAbout("\ndirve.path = \"a\"\n"), HasSubstr("m.toml, line 2: unknown key 'dirve'"));
  EXPECT_THAT(complaintAbout("root = \"a\"\n"), HasSubstr("has no drives"));
  EXPECT_THAT(complaintAbout("[[drives]\n"), HasSubstr("is no TOML"));
  EXPECT_THAT(complaintAbout("path,name\na\n", "m.csv"), HasSubstr("m.csv, line 2: has 1 fields"));
  EXPECT_THAT(complaintAbout("path,name\n\"a,b\n", "m.csv"), HasSubstr("a quote is not closed"));
  EXPECT_THAT(complaintAbout("path,set,a.b\nx,s,1\ny,s,2\n", "m.csv"), HasSubstr("line 3: set 's' has other"));
  EXPECT_THAT(complaintAbout("[[drives]]\npath = \"a\"\nname = \"a/b\"\n"), HasSubstr("is no name"));
  EXPECT_THAT(complaintAbout("[[drives]]\nscene = \"lead\"\nseeds = \"5-2\"\n"), HasSubstr("as 1-5"));
}

TEST_F(ManifestFile, SetsOfOneLineAreKeptInTheirOrder) {
  const Manifest manifest =
      read("sets = { b = {}, a = { backend = { kind = \"joint\" } } }\n[[drives]]\npath = \"x\"\n");
  ASSERT_EQ(manifest.sets.size(), 2U);
  EXPECT_EQ(manifest.sets[0].name, "b");
  EXPECT_THAT(manifest.sets[1].assignments, ElementsAre("backend.kind=joint"));
}

TEST_F(ManifestFile, ADriveMayBeOneOfSeveralPlacesAndStandForMany) {
  const Manifest manifest = read(R"(
dataset = "set"
published = "figures.toml"
[defaults]
optional = true
[[drives]]
each = ["00", "01"]
path = ["dataset/sequences/{}", "sequences/{}"]
name = "drive_{}"
[[drives]]
path = "other"
optional = false
)");
  ASSERT_EQ(manifest.entries.size(), 3U);
  EXPECT_EQ(manifest.entries[1].path, "dataset/sequences/01");
  EXPECT_THAT(manifest.entries[1].other_paths, ElementsAre("sequences/01"));
  EXPECT_EQ(manifest.entries[1].name, "drive_01");
  EXPECT_TRUE(manifest.entries[1].optional);
  EXPECT_FALSE(manifest.entries[2].optional);
  EXPECT_EQ(manifest.dataset, "set");
  EXPECT_EQ(manifest.published, folder_ / "figures.toml");
  fs::create_directories(folder_ / "sequences/01");
  const auto found = findDrives(manifest.entries[1], folder_.path());
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].path, folder_ / "sequences/01");
  EXPECT_FALSE(found[0].missing);
  const auto missing = findDrives(manifest.entries[0], folder_.path());
  EXPECT_TRUE(missing[0].missing);
  EXPECT_THAT(missing[0].problem,
              testing::AllOf(HasSubstr("dataset/sequences/00"), HasSubstr("nor at"), HasSubstr("sequences/00")));
}

TEST_F(ManifestFile, TheRootMayNameAVariableOrTheHomeFolder) {
  const std::string drive = "\n[[drives]]\npath = \"training/0000\"\n";
  ::unsetenv("MOTORCADE_TEST_ROOT");
  EXPECT_THAT(complaintAbout("root = \"$MOTORCADE_TEST_ROOT/sub\"" + drive),
              testing::AllOf(HasSubstr("$MOTORCADE_TEST_ROOT, which is not set"), HasSubstr("--root FOLDER"),
                             HasSubstr("export MOTORCADE_TEST_ROOT=FOLDER"), HasSubstr("training/0000")));
  EXPECT_EQ(readManifest(folder_ / "m.toml", "/given").root, "/given");
  ::setenv("MOTORCADE_TEST_ROOT", "/data", 1);
  EXPECT_EQ(read("root = \"$MOTORCADE_TEST_ROOT/sub\"" + drive).root, "/data/sub");
  EXPECT_EQ(read("root = \"${MOTORCADE_TEST_ROOT}2\"" + drive).root, "/data2");
  EXPECT_EQ(read("root = \"~/sub\"" + drive).root, fs::path(std::getenv("HOME")) / "sub");
}

/// Forms in which people first write the paths of a table or list.
class ManifestTable : public ManifestFile, public testing::WithParamInterface<std::pair<const char*, std::string>> {};

TEST_P(ManifestTable, IsTakenForWhatItSays) {
  const auto& [name, text] = GetParam();
  std::vector<std::string> paths;
  for (const ManifestEntry& entry : read(text, name).entries) paths.push_back(entry.path);
  EXPECT_THAT(paths, ElementsAre("a/0001", "b c/0002")) << text;
}

const std::vector<std::pair<const char*, std::string>> kTables{
    {"m.csv", "path\na/0001\nb c/0002\n"},
    {"m.csv", "drive\na/0001\nb c/0002\n"},
    {"m.csv", "Sequence\na/0001\nb c/0002\n"},
    {"m.csv", "FOLDER\na/0001\nb c/0002\n"},
    {"m.csv", "a/0001\nb c/0002\n"},
    {"m.csv", "a/0001\nb c/0002"},
    {"m.txt", "a/0001\nb c/0002\n"},
    {"m.list", "a/0001\nb c/0002\n"},
    {"m.txt", "\n# all of them\n  a/0001  \n\n\tb c/0002 # the second\n"},
    {"m.csv", "drive\r\na/0001\r\nb c/0002\r\n"},
    {"m.txt", "a/0001\rb c/0002\r"},
    {"m.csv",
     "\xEF\xBB\xBF"
     "drive\na/0001\nb c/0002\n"},
    {"m.txt",
     "\xEF\xBB\xBF"
     "a/0001\nb c/0002\n"},
    {"m.csv", "\"a/0001\"\n\"b c/0002\"\n"},
    {"m.txt", "'a/0001'\n'b c/0002'\n"},
    {"m.csv", "drive,name\na/0001,x\n\"b c/0002\",y\n"},
    {"m.csv", "name;drive;fps\nx;a/0001;10\ny;b c/0002;10\n"},
    {"m.tsv", "Name\tPath\nx\ta/0001\ny\tb c/0002\n"},
    {"m.csv", "drive,,\na/0001,,\nb c/0002,,\n,,\n"},
    {"m.csv", "a/0001,\nb c/0002,\n"},
    {"m.csv", ",drive\n0,a/0001\n1,b c/0002\n"},
    {"m.csv", " drive , name \n a/0001 , x \n b c/0002 , y \n"},
    {"m.csv", "# drives of May\n\ndrive\na/0001\nb c/0002\n"}};

INSTANTIATE_TEST_SUITE_P(First, ManifestTable, testing::ValuesIn(kTables));

TEST_F(ManifestFile, AListWithoutColumnsKeepsCommasInQuotesAlone) {
  EXPECT_EQ(read("\"a,b\"\n", "m.csv").entries.at(0).path, "a,b");
  EXPECT_EQ(read("a#1\n", "m.txt").entries.at(0).path, "a#1");
  EXPECT_THAT(complaintAbout("a/0001,first\n", "m.csv"),
              testing::AllOf(HasSubstr("m.csv, line 1"), HasSubstr("names no column 'path'")));
  EXPECT_THAT(complaintAbout("drive\n# none yet\n", "m.csv"), HasSubstr("has no drives; write a line with the path"));
  EXPECT_THAT(complaintAbout(std::string("\xFF\xFE"
                                         "a\0",
                                         4),
                             "m.csv"),
              HasSubstr("save it as CSV in UTF-8"));
  EXPECT_THAT(complaintAbout("drive,weather\na,rain\n", "m.csv"), HasSubstr("unknown key 'weather'"));
}

TEST_F(ManifestFile, ATableMayNameTheHomeFolder) {
  const auto found = findDrives(read("~/nowhere_of_mine\n", "m.txt").entries.at(0), folder_.path());
  EXPECT_EQ(found.at(0).path, fs::path(std::getenv("HOME")) / "nowhere_of_mine");
}

/// Manifests that the project brings along.
TEST(PublicDatasets, EachIsReadWithARootAndItsDrivesMayBeMissing) {
  std::size_t manifests = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(MOTORCADE_SOURCE_DIR) / "perf" / "datasets")) {
    if (entry.path().filename() == "published.toml" || entry.path().extension() != ".toml") continue;
    const Manifest manifest = readManifest(entry.path(), "/nowhere");
    ++manifests;
    EXPECT_FALSE(manifest.dataset.empty()) << entry.path();
    std::set<std::string> names;
    for (const ManifestEntry& drive : manifest.entries) {
      EXPECT_TRUE(drive.optional) << drive.where;
      EXPECT_FALSE(drive.name.empty()) << drive.where;
      EXPECT_TRUE(names.insert(drive.name).second) << drive.name << " is twice in " << entry.path();
      EXPECT_TRUE(findDrives(drive, manifest.root).at(0).missing);
    }
  }
  EXPECT_EQ(manifests, 5U);
}

TEST(PublicDatasets, HaveAllTheirDrives) {
  const auto drives = [](const std::string& name) {
    const fs::path file = fs::path(MOTORCADE_SOURCE_DIR) / "perf" / "datasets" / name;
    return readManifest(file, "/nowhere").entries.size();
  };
  EXPECT_EQ(drives("kitti_tracking.toml"), 21U);
  EXPECT_EQ(drives("kitti_odometry.toml"), 11U);
  EXPECT_EQ(drives("kitti_360.toml"), 9U);
  EXPECT_EQ(drives("virtual_kitti_2.toml"), 50U);
  EXPECT_EQ(drives("euroc.toml"), 11U);
}

TEST(PublicDatasets, EachPublishedFigureIsOfADriveThatItsManifestHasAndHasASource) {
  const fs::path folder = fs::path(MOTORCADE_SOURCE_DIR) / "perf" / "datasets";
  for (const char* const name : {"kitti_tracking", "kitti_odometry"}) {
    std::set<std::string> drives;
    for (const ManifestEntry& drive : readManifest(folder / (std::string(name) + ".toml"), "/nowhere").entries)
      drives.insert(drive.name);
    const auto figures = readPublishedFigures(folder / "published.toml", name);
    EXPECT_GE(figures.size(), 4U);
    for (const PublishedFigure& figure : figures) {
      EXPECT_GT(figure.source.size(), 20U);
      EXPECT_GT(figure.value, 0);
      for (const std::string& drive : figure.drives) EXPECT_TRUE(drives.contains(drive)) << figure.method << drive;
      EXPECT_EQ(figure.frames.size(), figure.drives.size());
      EXPECT_THAT(figure.frames, testing::Each(testing::Gt(70)));
    }
  }
}

TEST_F(ManifestFile, AFigureWithoutSourceUnitOrValueIsRefused) {
  const std::string good =
      "[[figures]]\ndataset=\"d\"\nmethod=\"m\"\nmeasure=\"camera_ate_m\"\nunit=\"m\"\nsource=\"paper, table\"\n";
  const auto complaint = [&](const std::string& text) {
    std::ofstream(folder_ / "f.toml") << text;
    return test::messageOf<UsageError>([&] { readPublishedFigures(folder_ / "f.toml", "d"); });
  };
  std::ofstream(folder_ / "f.toml") << good + "values = { \"0\" = 1.5, \"1\" = 2 }\n";
  const auto figures = readPublishedFigures(folder_ / "f.toml", "d");
  ASSERT_EQ(figures.size(), 2U);
  EXPECT_EQ(figures[0].value, 1.5);
  EXPECT_TRUE(readPublishedFigures(folder_ / "f.toml", "another").empty());
  EXPECT_THAT(complaint(good), testing::AllOf(HasSubstr("f.toml, line 1"), HasSubstr("'values'")));
  EXPECT_THAT(complaint(good + "values = { \"0\" = \"1\" }\n"), HasSubstr("'0' must be a number"));
  EXPECT_THAT(complaint(good + "mean_of = [\"0\"]\nvalue = 1\n"), HasSubstr("two drives at least"));
  EXPECT_THAT(complaint(good + "values = { \"0\" = 1 }\npage = 3\n"), HasSubstr("unknown key 'page'"));
  const auto without = [&](const std::string& line) {
    std::string text = good + "values = { \"0\" = 1 }\n";
    return text.erase(text.find(line), line.size());
  };
  EXPECT_THAT(complaint(without("source=\"paper, table\"\n")), HasSubstr("needs 'source'"));
  EXPECT_THAT(complaint(without("unit=\"m\"\n") + "unit = \"deg\"\n"), HasSubstr("does not end with _deg"));
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
