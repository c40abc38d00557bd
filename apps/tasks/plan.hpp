#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace motorcade {

/// A published figure, to stand beside a measure of the same definition.
struct PublishedFigure {
  std::string method{}, measure{};    // the measure as a column of results.csv
  std::vector<std::string> drives{};  // by their names; of several, the figure is the mean
  std::vector<int> frames{};          // that each of them has; 0 where that is not told
  double value = 0;
  std::string source{};  // paper and table
  std::string note{};    // what differs in how it was measured; may be empty
};

/// Reads the figures of one data set from a file (docs/formats.md). Throws UsageError naming file, line, key and how to
/// fix it; a figure without a source is refused.
std::vector<PublishedFigure> readPublishedFigures(const std::filesystem::path& file, const std::string& dataset);

/// One drive to run once, with one set of parameters: the unit of work of a batch.
struct Task {
  std::string name{};                   // of its folder: DRIVE[-SEED].SET[.REPETITION]
  std::string drive{}, set{};           // as the manifest names them
  std::optional<std::uint32_t> seed{};  // of a scene, or of injected faults
  int repetition = 1;
  std::filesystem::path sequence{};               // absolute
  std::vector<std::string> render_arguments{};    // of `motorcade synth`, behind its folder; empty for a recorded drive
  std::vector<std::string> run_arguments{};       // of `motorcade run`, behind its sequence and folder
  std::vector<std::string> evaluate_arguments{};  // of `motorcade evaluate`, behind its run
  std::int64_t frames = 0;                        // expected; 0 where it is not known before a scene is rendered
  bool has_truth = false;                         // the run can be evaluated
  int threads = 2;
  std::string fingerprint{};  // of all that its result depends on
  std::string problem{};      // why it cannot be performed; empty where it can
};

/// A drive of the manifest that is missing, and may be.
struct LeftOutDrive {
  std::string name{};
  std::string looked_for{};  // path, or several
};

/// All tasks of a batch, in the order of the manifest.
struct Plan {
  std::filesystem::path manifest{}, program{};  // absolute; the program that tasks run
  std::string program_stamp{};                  // its file as it was when this was planned
  std::string baseline_set{};                   // whose objects others are compared with when merging; empty for none
  std::vector<Task> tasks{};
  std::vector<LeftOutDrive> left_out{};
  std::vector<PublishedFigure> published{};  // of the manifest's data set
};

/// Throws OutputError.
void writePlan(const std::filesystem::path& file, const Plan& plan);
/// Throws InputError naming the file and how to fix it.
Plan readPlan(const std::filesystem::path& file);

}  // namespace motorcade
