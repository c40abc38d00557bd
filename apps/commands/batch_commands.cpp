#include <memory>

#include "apps/batch/batch_command.hpp"
#include "apps/commands/command_options.hpp"
#include "apps/merge/merged_files.hpp"
#include "io/files/errors.hpp"

namespace motorcade {
namespace {

constexpr int kMostJobs = 4096, kMostThreads = 1024, kMostMemory_mb = 4'000'000;

void addSlurm(CLI::App& command, const std::shared_ptr<BatchOptions>& options) {
  SlurmOptions& slurm = options->slurm_options;
  CLI::Option* const asked =
      command.add_flag("--slurm", options->slurm, "Submit the tasks as a job array with sbatch, and come back");
  command.add_option("--partition", slurm.partition, "Slurm's partition")->needs(asked);
  command.add_option("--array-limit", slurm.array_limit, "Tasks that Slurm runs at the same time, at most")
      ->needs(asked)
      ->check(CLI::PositiveNumber);
  command.add_option("--memory", slurm.memory_mb, "Memory that a task asks Slurm for [MB]")
      ->needs(asked)
      ->check(CLI::Range(1, kMostMemory_mb))
      ->capture_default_str();
  command.add_flag("--dry-run", slurm.dry_run, "Print the scripts, submit nothing")->needs(asked);
}

void addSelection(CLI::App& command, Selection& only) {
  typed(command, "NAME[,NAME]", "--drives", only.drives, "Only these drives and scenes of the manifest")
      ->delimiter(',');
  typed(command, "NAME[,NAME]", "--sets", only.sets, "Only these sets of parameters")->delimiter(',');
  command.add_option("--seeds", only.seeds, "Seeds of all scenes, in place of the manifest's, as 1-5");
}

void addTask(CLI::App& batch, Action& action) {
  const auto [command, options] =
      addCommand(batch, action, "task", "Perform one task of a planned batch, as Slurm's scripts do", runBatchTask);
  command.add_option("DIR", options.batch, "Folder of the batch")->required();
  command.add_option("--list", options.list, "File with names of tasks, one per line")->required();
  command.add_option("--index", options.index, "Which line, counted from 0")->required();
  command.add_flag("--render", options.only_render, "Render the task's scene, no more");
}

void addStatus(CLI::App& batch, Action& action) {
  const auto [command, options] =
      addCommand(batch, action, "status", "Tell how far a batch is, here or in Slurm", runBatchStatus);
  command.add_option("DIR", options.batch, "Folder of the batch")->required();
  command.add_option("--json", options.json, "File for the state of each task as JSON");
}

void addCancel(CLI::App& batch, Action& action) {
  const auto [command, folder] =
      addCommand(batch, action, "cancel", "End what runs of a batch; finished results stay", runBatchCancel);
  command.add_option("DIR", folder, "Folder of the batch")->required();
}

void addMerge(CLI::App& batch, Action& action) {
  const auto [command, options] =
      addCommand(batch, action, "merge", "Write one table and one page of all results", runMerge);
  command.add_option("DIR", options.batch, "Folder of the batch")->required();
  command.add_option("--out", options.out, "Folder for them; DIR/merged when absent");
  command.add_option("--against", options.against, "Folder of another batch of the same drives, to compare with");
  command.add_option("--baseline-set", options.baseline_set,
                     "Set of parameters that relative errors are taken against; the manifest's when absent");
}

}  // namespace

void addBatch(CLI::App& app, Action& action) {
  const auto options = std::make_shared<BatchOptions>();
  CLI::App* command = app.add_subcommand("batch", "Run and evaluate many drives, here or on a Slurm cluster");
  command->add_option("MANIFEST", options->manifest,
                      "The drives and how to run them, as TOML, a table (.csv) or a list (.txt), see docs/formats.md");
  command->add_option("--out", options->out, "Folder for all results; what is finished there is not done again");
  command->add_option("-j,--jobs", options->jobs, "Tasks at a time; as many as there are processors for when absent")
      ->check(CLI::Range(1, kMostJobs));
  command->add_option("--threads", options->threads, "Workers of each run, and processors that it is kept to")
      ->check(CLI::Range(1, kMostThreads))
      ->capture_default_str();
  command->add_option("--time", options->slurm_options.time, "Time limit of a task: minutes, H:MM:SS or D-HH:MM:SS");
  command->add_flag("--retry", options->retry, "Also what failed before");
  command->add_option("--root", options->root,
                      "Folder that the manifest's paths are relative to; the manifest's own root when absent");
  command->add_option("--sequences", options->sequences, "Folder for rendered scenes, which several batches may share");
  command->add_option("--program", options->program, "The motorcade that does the work, as of another version")
      ->check(CLI::ExistingFile);
  addSelection(*command, options->only);
  addSlurm(*command, options);
  addStatus(*command, action);
  addMerge(*command, action);
  addCancel(*command, action);
  addTask(*command, action);
  command->require_subcommand(0, 1);
  command->footer(
      "Examples: motorcade batch MANIFEST.toml --out BATCH -j 4\n"
      "          motorcade batch merge BATCH --against BATCH_BEFORE");
  command->callback([command, options, &action] {
    if (!command->get_subcommands().empty()) return;
    if (options->manifest.empty()) throw CLI::RequiredError("MANIFEST");
    if (options->out.empty()) throw CLI::RequiredError("--out");
    action = [options] { return runBatch(*options); };
  });
}

}  // namespace motorcade
