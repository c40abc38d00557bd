#pragma once

#include <filesystem>
#include <iterator>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json_fwd.hpp>

#include "apps/evaluate/measures/belief_measures.hpp"
#include "apps/evaluate/measures/evaluation.hpp"
#include "io/results/run_folder.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// The evaluation as a table to read, final beside online, of at most 100 columns; the legend stands at its end.
std::string tableOf(const Evaluation& evaluation);
/// The same with every number, as JSON.
std::string jsonOf(const Evaluation& evaluation);

/// `rows`, `brier`, `largest_gap` and `tenths`; null for values that so few rows cannot tell. `hits` is the key of the
/// probability's event, such as "real".
nlohmann::ordered_json jsonOf(const Reliability& reliability, const char* hits);

/// Counts and shares, and by track and label the frames of what is false or missed.
nlohmann::ordered_json jsonOf(const DetectionErrors& errors);

// Parts of the table that `tableOf` puts together.

/// Appends a formatted text.
template <class... Values>
void print(std::string& text, fmt::format_string<Values...> format, Values&&... values) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Values>(values)...);
}

/// The run, its sequence and its truth.
void printHead(std::string& text, const Evaluation& evaluation);
/// Errors of the camera's path, as a whole and over segments.
void printCamera(std::string& text, const Evaluation& evaluation);
/// Errors of the objects' motions and speeds.
void printMotions(std::string& text, const Evaluation& evaluation);
/// Recall, false rows and id switches, and in which frames the rows are false.
void printDetection(std::string& text, const Evaluation& evaluation);

/// Writes a run's objects as KITTI tracking results for KITTI's own evaluation: `final/data/NAME.txt` and
/// `online/data/NAME.txt` in the folder. NAME is that of the sequence's folder. Other sequences' files stay, so that
/// many runs share one folder. Needs no ground truth. Throws OutputError.
void exportKitti(const std::filesystem::path& folder, const RunFolder& run, const Sequence& sequence);

/// Evaluates a run, prints the table and writes the other requested files; returns the exit code. Failures are
/// UserErrors.
int runEvaluate(const EvaluateOptions& options);

}  // namespace motorcade
