#include "apps/batch/slurm_script.hpp"

#include <fmt/format.h>

#include "io/files/errors.hpp"

namespace motorcade {
namespace {

/// Quotes a text as one word of a shell.
std::string quoted(const std::string& text) {
  std::string word = "'";
  for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return word + "'";
}

std::string headOf(const std::string& name, const std::filesystem::path& log, const SlurmOptions& options) {
  std::string head = "#!/bin/sh\n";
  const auto add = [&](const std::string& line) { head += "#SBATCH " + line + "\n"; };
  add("--job-name=motorcade-" + name);
  add("--output=" + log.string());
  add("--open-mode=append");
  if (!options.partition.empty()) add("--partition=" + options.partition);
  return head;
}

}  // namespace

void requireWritableInScript(const std::filesystem::path& path) {
  constexpr const char* kUnwritable = " \t\n\r\"'\\%#";
  if (path.string().find_first_of(kUnwritable) != std::string::npos)
    throw UsageError(path.string() + ": Slurm's scripts cannot name this folder; choose one without blanks, quotes, " +
                     "backslashes, % and #");
}

std::string SlurmScripts::array(const SlurmArray& array) const {
  std::string text = headOf(array.name, submission / (array.name + "_%a.log"), options);
  const auto add = [&](const std::string& line) { text += "#SBATCH " + line + "\n"; };
  const std::string limit = options.array_limit > 0 ? fmt::format("%{}", options.array_limit) : "";
  add(fmt::format("--array=0-{}{}", array.count - 1, limit));
  add(fmt::format("--nodes=1 --ntasks=1 --cpus-per-task={}", threads));
  add(fmt::format("--mem={}M", options.memory_mb));
  if (!options.time.empty()) add("--time=" + options.time);
  add("--requeue");           // after the loss of a node
  add("--signal=B:TERM@30");  // 30 s before the end of its time a task is told to end
  text += fmt::format("exec {} batch task {} --list {} --index $(({} + SLURM_ARRAY_TASK_ID)){}\n",
                      quoted(program.string()), quoted(batch.string()), quoted(array.list.string()), array.first,
                      array.only_render ? " --render" : "");
  return text;
}

std::string SlurmScripts::merge() const {
  return headOf("merge", submission / "merge.log", options) + "#SBATCH --ntasks=1\n" +
         fmt::format("#SBATCH --mem={}M\n", options.memory_mb) +
         fmt::format("exec {} batch merge {}\n", quoted(program.string()), quoted(batch.string()));
}

}  // namespace motorcade
