#include "apps/tasks/planner.hpp"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/files/errors.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

const fs::path kDrive = MOTORCADE_TINY_SEQUENCE;

class PlanOf : public testing::Test {
 protected:
  PlanOf() { std::ofstream(folder_ / "program") << "one version\n"; }

  Plan plan(const std::string& manifest) {
    std::ofstream(folder_ / "m.toml") << manifest;
    return planOf(readManifest(folder_ / "m.toml"),
                  {.program = folder_ / "program", .sequences = folder_ / "sequences", .threads = 1});
  }
  std::string drive() const { return "path = \"" + kDrive.string() + "\"\n"; }

  const test::TemporaryFolder folder_;
};

std::vector<std::string> namesOf(const Plan& plan) {
  std::vector<std::string> names;
  for (const Task& task : plan.tasks) names.push_back(task.name);
  return names;
}

TEST_F(PlanOf, ATaskForEachDriveSeedSetAndRepetition) {
  const Plan planned = plan("[sets.a]\n[sets.b]\nbackend.kind=\"filter\"\n[[drives]]\nname=\"d\"\nrepetitions=2\n" +
                            drive() + "[[drives]]\nscene=\"lead\"\nseeds=[1,2]\nsets=[\"b\"]\nlength=20\n");
  EXPECT_THAT(namesOf(planned), ElementsAre("d.a.1", "d.a.2", "d.b.1", "d.b.2", "lead-1.b", "lead-2.b"));
  EXPECT_THAT(planned.tasks[2].run_arguments, ElementsAre("--threads", "1", "--set", "backend.kind=filter"));
  EXPECT_EQ(planned.tasks[0].frames, 14);
  EXPECT_TRUE(planned.tasks[0].has_truth);
  EXPECT_EQ(planned.tasks[4].sequence, folder_ / "sequences" / "lead-1-20frames");
  EXPECT_THAT(planned.tasks[4].render_arguments, ElementsAre("--scene", "lead", "--seed", "1", "--frames", "20"));
}

TEST_F(PlanOf, ASceneOnARigWithErrorsIsAnotherDrive) {
  const Plan planned = plan("[[drives]]\nscene=\"lead\"\nname=\"rig\"\nseeds=[1]\ncalibration_errors=1\nshake=0.03\n");
  ASSERT_EQ(planned.tasks.size(), 1U);
  EXPECT_EQ(planned.tasks[0].sequence, folder_ / "sequences" / "lead-1-calibration1-shake0.03");
  EXPECT_THAT(planned.tasks[0].render_arguments,
              ElementsAre("--scene", "lead", "--seed", "1", "--calibration-errors", "1", "--shake", "0.03"));
}

TEST_F(PlanOf, SeedsGoToInjectedFaults) {
  const Plan planned = plan("[[drives]]\nname=\"d\"\ninject=\"noise=20\"\nseeds=[7]\n" + drive());
  EXPECT_THAT(planned.tasks[0].run_arguments, ElementsAre("--threads", "1", "--inject", "noise=20,seed=7"));
}

TEST_F(PlanOf, WhatIsWrongWithADriveOrASetIsItsTasksAlone) {
  const Plan planned =
      plan("[sets.good]\n[sets.bad]\nbackend.kind=\"none\"\n[[drives]]\nname=\"d\"\n" + drive() +
           "[[drives]]\npath=\"nowhere\"\nsets=[\"good\"]\n[[drives]]\nscene=\"leed\"\nsets=[\"good\"]\n");
  ASSERT_EQ(planned.tasks.size(), 4U);
  EXPECT_EQ(planned.tasks[0].problem, "");
  EXPECT_THAT(planned.tasks[1].problem, HasSubstr("set bad: --set backend.kind=none"));
  EXPECT_THAT(planned.tasks[2].problem, HasSubstr("no such drive"));
  EXPECT_THAT(planned.tasks[3].problem, HasSubstr("there is no scene 'leed'"));
}

TEST_F(PlanOf, TwoDrivesOfOneNameAreRefused) {
  fs::create_directories(folder_ / "other" / kDrive.filename());
  EXPECT_THROW(plan("[[drives]]\n" + drive() + "[[drives]]\npath=\"other/" + kDrive.filename().string() + "\"\n"),
               UsageError);
  EXPECT_THROW(plan("[[drives]]\n" + drive() + "[[drives]]\n" + drive()), UsageError);
}

TEST_F(PlanOf, TheFingerprintFollowsWhatTheResultDependsOn) {
  const std::string manifest = "[[drives]]\nname=\"d\"\npath=\"copy\"\n";
  fs::copy(kDrive, folder_ / "copy", fs::copy_options::recursive);
  const auto fingerprint = [&](const std::string& text) { return plan(text).tasks.front().fingerprint; };
  const std::string first = fingerprint(manifest);
  EXPECT_EQ(fingerprint(manifest), first);
  EXPECT_NE(fingerprint("[sets.default]\nbackend.kind=\"filter\"\n" + manifest), first);
  EXPECT_NE(fingerprint(manifest + "frames=\"0:10\"\n"), first);
  std::ofstream(folder_ / "program") << "another version\n";
  const std::string second = fingerprint(manifest);
  EXPECT_NE(second, first);
  const fs::path image = folder_ / "copy" / "image_0" / "000003.png";
  ASSERT_TRUE(fs::exists(image));
  fs::last_write_time(image, fs::last_write_time(image) + std::chrono::seconds(1));
  EXPECT_NE(fingerprint(manifest), second);
}

TEST_F(PlanOf, IsReadBackAsItWasWritten) {
  const Plan planned =
      plan("baseline_set=\"a\"\n[sets.a]\n[[drives]]\nscene=\"lead\"\nseeds=[3]\n[[drives]]\nname=\"d\"\n" + drive());
  writePlan(folder_ / "plan.json", planned);
  const Plan read = readPlan(folder_ / "plan.json");
  EXPECT_EQ(read.manifest, planned.manifest);
  EXPECT_EQ(read.program_stamp, planned.program_stamp);
  EXPECT_EQ(read.baseline_set, "a");
  ASSERT_EQ(read.tasks.size(), planned.tasks.size());
  for (std::size_t i = 0; i < read.tasks.size(); ++i) {
    EXPECT_EQ(read.tasks[i].name, planned.tasks[i].name);
    EXPECT_EQ(read.tasks[i].seed, planned.tasks[i].seed);
    EXPECT_EQ(read.tasks[i].sequence, planned.tasks[i].sequence);
    EXPECT_EQ(read.tasks[i].render_arguments, planned.tasks[i].render_arguments);
    EXPECT_EQ(read.tasks[i].run_arguments, planned.tasks[i].run_arguments);
    EXPECT_EQ(read.tasks[i].frames, planned.tasks[i].frames);
    EXPECT_EQ(read.tasks[i].has_truth, planned.tasks[i].has_truth);
    EXPECT_EQ(read.tasks[i].fingerprint, planned.tasks[i].fingerprint);
  }
  std::ofstream(folder_ / "plan.json") << "{";
  EXPECT_THROW(readPlan(folder_ / "plan.json"), InputError);
}

}  // namespace
}  // namespace motorcade
