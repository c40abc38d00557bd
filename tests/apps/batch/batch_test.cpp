#include <gmock/gmock.h>

#include "apps/tasks/batch_folder.hpp"
#include "apps/tasks/task_record.hpp"
#include "tests/apps/program_run.hpp"

/// `motorcade batch` from outside, on a short rendered drive.
namespace motorcade::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr int kExitFailedTasks = 6;

class Batch : public Run {
 protected:
  void write(const std::string& manifest) { std::ofstream(out("m.toml")) << manifest; }
  std::string drive(const std::string& more = "") const {
    return "[[drives]]\nname = \"drive\"\npath = \"" + kSequence.string() + "\"\n" + more + "\n";
  }
  int batch(const std::string& options = "-j 2 --threads 1", const std::string& prefix = "") {
    return motorcade("batch " + out("m.toml").string() + " --out " + out("batch").string() + " " + options, prefix);
  }
  int status() { return motorcade("batch status " + out("batch").string() + " --json " + out("s.json").string()); }
  std::string output() const { return contentOf(out("stdout")); }
  BatchFolder folder() const { return BatchFolder(out("batch")); }
};

TEST_F(Batch, GivesWhatRunAndEvaluateGive) {
  write(drive("repetitions = 2"));
  ASSERT_EQ(batch(), 0) << contentOf(errors());
  ASSERT_EQ(run("alone"), 0);
  for (const char* const task : {"drive.default.1", "drive.default.2"}) {
    const fs::path result = folder().result(task);
    for (const std::string& file : kReproducible)
      EXPECT_TRUE(contentOf(runIn(result) / file) == contentOf(out("alone") / file)) << file;
    const auto measures = nlohmann::json::parse(contentOf(evaluationIn(result)));
    EXPECT_EQ(measures["final"], evaluate("alone")["final"]);
    EXPECT_EQ(readTaskRecord(recordIn(result)).processors.size(), 1U);
  }
}

TEST_F(Batch, DoesNothingTwiceAndWhatFailedOnlyWhenAsked) {
  write(drive() + "[[drives]]\npath = \"nowhere\"\n");
  EXPECT_EQ(batch(), kExitFailedTasks);
  EXPECT_THAT(contentOf(errors()), HasSubstr("nowhere: there is no such drive"));
  EXPECT_THAT(output(), HasSubstr("2 tasks: 1 done, 0 finished before, 1 failed\n"));
  const std::string first = readTaskRecord(recordIn(folder().result("drive.default"))).started;
  EXPECT_EQ(batch(), kExitFailedTasks);
  EXPECT_THAT(output(), HasSubstr("2 tasks: 0 done, 1 finished before, 1 failed, 1 of them before"));
  EXPECT_EQ(readTaskRecord(recordIn(folder().result("drive.default"))).started, first);
  fs::copy(kSequence, out("nowhere"), fs::copy_options::recursive);  // mended: that is another task
  EXPECT_EQ(batch(), 0);
  EXPECT_THAT(output(), HasSubstr("2 tasks: 1 done, 1 finished before, 0 failed\n"));
  EXPECT_FALSE(fs::exists(folder().failure("nowhere.default")));
}

TEST_F(Batch, TriesWhatFailedAgainWhenAsked) {
  write(drive("inject = \"black@3:12\"\nrequire = \"tracked=0.9\""));
  EXPECT_EQ(batch(), kExitFailedTasks);
  EXPECT_EQ(readTaskRecord(recordIn(folder().failure("drive.default"))).failure->exit_code, 5);
  EXPECT_EQ(batch("--retry"), kExitFailedTasks);
  EXPECT_THAT(output(), HasSubstr("1 tasks: 0 done, 0 finished before, 1 failed\n"));
}

TEST_F(Batch, GoesOnWhereItWasInterrupted) {
  write(drive("rate = 5\nrepetitions = 4"));
  const std::string until_one_runs = waitForLines(folder().attempts() / "drive.default.3~*" / "run" / "frames.csv", 3);
  const std::string cancel = MOTORCADE_PROGRAM " batch cancel " + out("batch").string() + " >/dev/null";
  EXPECT_EQ(batch("-j 2 --threads 1", "(" + until_one_runs + cancel + ") & "), 143);
  EXPECT_TRUE(fs::is_empty(folder().attempts()));
  EXPECT_FALSE(fs::exists(folder().result("drive.default.3")));
  int done = 0;  // the third begins when one of the first two is
  for (const std::string task : {"drive.default.1", "drive.default.2"}) done += fs::exists(folder().result(task));
  EXPECT_GE(done, 1);
  const std::string before = std::to_string(done), others = std::to_string(4 - done);
  ASSERT_EQ(status(), 0);
  EXPECT_THAT(output(), HasSubstr("4 tasks, " + before + " done, " + others + " waiting"));
  EXPECT_EQ(batch(), 0);
  EXPECT_THAT(output(), HasSubstr("4 tasks: " + others + " done, " + before + " finished before, 0 failed"));
}

TEST_F(Batch, AKilledTaskIsNamedAndTheOthersGoOn) {
  write(drive("rate = 7\nrepetitions = 3"));
  const std::string until_one_runs = waitForLines(folder().attempts() / "drive.default.1~*" / "run" / "frames.csv", 3);
  const std::string kill = "pkill -KILL -f '[m]otorcade run " + kSequence.string() + ".*--rate 7'";
  EXPECT_EQ(batch("-j 1 --threads 1", "(" + until_one_runs + kill + ") & "), kExitFailedTasks);
  EXPECT_THAT(output(), AllOf(HasSubstr("3 tasks: 2 done, 0 finished before, 1 failed"),
                              HasSubstr("drive.default.1: run was killed (signal 9)")));
  ASSERT_EQ(status(), 0);
  EXPECT_EQ(nlohmann::json::parse(contentOf(out("s.json")))["tasks"][0]["state"], "failed");
}

TEST_F(Batch, AFullDiskIsNamedAndTheOthersGoOn) {
  write("[sets.plain]\n[sets.masks]\n" + drive("sets = [\"plain\"]"));
  // The log of a task, and its run, may have no file above 4 kB: plan and records are smaller.
  EXPECT_EQ(batch("-j 1", "ulimit -f 8; "), kExitFailedTasks);
  const auto record = readTaskRecord(recordIn(folder().failure("drive.plain")));
  EXPECT_EQ(record.failure->exit_code, 4);
  EXPECT_THAT(record.failure->last_lines.back(), HasSubstr("File too large"));
  EXPECT_EQ(batch("-j 1 --retry"), 0);
}

TEST_F(Batch, OnlyOneRunnerWorksInAFolder) {
  write(drive("rate = 5"));
  const std::string command = MOTORCADE_PROGRAM " batch " + out("m.toml").string() + " --out " + out("batch").string();
  const std::string until_one_runs = waitForLines(folder().attempts() / "*" / "run" / "frames.csv", 3);
  EXPECT_EQ(batch("", "(" + command + " >/dev/null 2>&1) & " + until_one_runs), 4);
  EXPECT_THAT(contentOf(errors()), HasSubstr("is in use by another"));
  EXPECT_EQ(motorcade("batch cancel " + out("batch").string()), 0);
  EXPECT_THAT(output(), HasSubstr("told process"));
}

TEST_F(Batch, SelectsDrivesSetsAndSeeds) {
  write("[sets.a]\n[sets.b]\nbackend.kind=\"filter\"\n" + drive() + "[[drives]]\npath = \"nowhere\"\n");
  EXPECT_EQ(batch("--drives drive --sets b"), 0);
  EXPECT_TRUE(fs::exists(folder().result("drive.b")));
  EXPECT_FALSE(fs::exists(folder().result("drive.a")));
  EXPECT_EQ(batch("--drives driv"), 2);
  EXPECT_THAT(contentOf(errors()), HasSubstr("did you mean drive?"));
}

TEST_F(Batch, AnotherVersionOfTheProgramCanDoTheWork) {
  write(drive());
  EXPECT_EQ(batch("--program /bin/true"), 0);
  EXPECT_FALSE(fs::exists(runIn(folder().result("drive.default"))));
  EXPECT_EQ(batch(), 0);  // done by another program, it counts as not done
  EXPECT_TRUE(fs::exists(runIn(folder().result("drive.default"))));
}

TEST_F(Batch, ADryRunForSlurmPrintsItsScriptsAndSubmitsNothing) {
  write(drive("repetitions = 3"));
  EXPECT_EQ(batch("--slurm --dry-run --partition fast --time 30 --array-limit 2"), 0) << contentOf(errors());
  EXPECT_THAT(output(), AllOf(HasSubstr("#SBATCH --array=0-2%2\n"), HasSubstr("#SBATCH --partition=fast\n"),
                              HasSubstr("#SBATCH --time=30\n"), HasSubstr("nothing was submitted")));
  ASSERT_EQ(status(), 0);
  EXPECT_THAT(output(), HasSubstr("3 tasks, 3 waiting"));
}

TEST_F(Batch, WrongUseIsExplained) {
  EXPECT_EQ(motorcade("batch"), 2);
  EXPECT_EQ(motorcade("batch " + out("none.toml").string() + " --out " + out("batch").string()), 2);
  EXPECT_THAT(contentOf(errors()), HasSubstr("none.toml"));
  EXPECT_EQ(motorcade("batch status " + out("").string()), 3);
  EXPECT_THAT(contentOf(errors()), HasSubstr("is no folder of a batch"));
  write(drive());
  EXPECT_EQ(batch("--partition x"), 2);
  EXPECT_EQ(batch("--time soon"), 2);
  EXPECT_THAT(contentOf(errors()), HasSubstr("--time soon: write minutes"));
}

}  // namespace
}  // namespace motorcade::test
