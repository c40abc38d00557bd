#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/tasks/batch_folder.hpp"

/// The folders of attempts that are under way, or that a killed process left: TASK~WHO.
namespace motorcade {

/// WHO of a task that this process performs in one of its slots: HOST-PID-SLOT.
std::string localAttemptName(std::size_t slot);
/// WHO of a task that Slurm has this process perform, slurm-JOB_INDEX-RESTART-PID; empty outside of Slurm. When a node
/// was lost for a while, two processes may perform the same element.
std::string slurmAttemptName();

struct Attempt {
  std::filesystem::path folder{};
  std::string task{}, who{};
  bool alive = true;  // as far as this machine can tell
  bool bySlurm() const { return who.starts_with("slurm-"); }
};
/// All of a batch, in the order of their tasks.
std::vector<Attempt> attemptsOf(const BatchFolder& folder);

/// Removes attempts of this machine's processes that are no longer alive, from this folder and that of the sequences.
void removeDeadAttempts(const std::filesystem::path& folder);
/// Removes what an element of an array left before Slurm restarted it, as its node was lost. If the earlier process
/// still runs, it fails and does no harm.
void removeEarlierRestarts(const BatchFolder& folder, const std::string& slurm_attempt);

}  // namespace motorcade
