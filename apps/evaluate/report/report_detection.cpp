#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "apps/evaluate/report/report.hpp"
#include "io/files/number_ranges.hpp"

namespace motorcade {
namespace {

using FramesById = std::map<std::int64_t, std::vector<std::int64_t>>;

void printRecall(std::string& text, const DetectionCounts& recall) {
  std::string counts;
  print(counts, "{:5.1f} % ({}/{})", 100 * recall.recall(), recall.found, recall.labels);
  print(text, " {:<19}", counts);
}

void printDetectionLine(std::string& text, const char* kind, const DetectionErrors& errors, bool from_fifth) {
  print(text, "  {:<8}", kind);
  printRecall(text, from_fifth ? errors.within_30m_from_fifth : errors.within_30m);
  printRecall(text, from_fifth ? errors.from_30_to_50m_from_fifth : errors.from_30_to_50m);
  print(text, " {:6} {:5} {:9} {:8} {:8} {:6.3f}\n", errors.false_rows, errors.rows, errors.false_rows_unlabeled,
        errors.false_rows_in_ignored, errors.id_switches, errors.mota);
}

/// A line for each id, of at most 100 columns.
void printFrames(std::string& text, const char* what, const char* of, const FramesById& by_id) {
  constexpr std::size_t kColumns = 48;  // of the frames
  constexpr int kMostLines = 8;
  int lines = 0;
  for (const auto& [id, frames] : by_id) {
    if (++lines > kMostLines) {
      print(text, "  {}: and of {} more, see --json\n", what, by_id.size() - kMostLines);
      return;
    }
    std::string ranges = rangesOf(frames);
    if (ranges.size() > kColumns) ranges = ranges.substr(0, ranges.rfind(',', kColumns)) + ", ...";
    print(text, "  {}: {} {} in frames {}\n", what, of, id, ranges);
  }
}

nlohmann::ordered_json jsonOf(const FramesById& by_id) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const auto& [id, frames] : by_id) json[std::to_string(id)] = frames;
  return json;
}

nlohmann::ordered_json jsonOf(const DetectionCounts& counts) {
  return {{"labels", counts.labels}, {"found", counts.found}, {"recall", counts.recall()}};
}

}  // namespace

void printDetection(std::string& text, const Evaluation& e) {
  text += "\ndetection  recall              recall               false    of    false, false in       id   MOTA\n";
  text += "           to 30 m             30 to 50 m            rows  rows unlabeled DontCare switches\n";
  printDetectionLine(text, "final", e.final.detection, false);
  printDetectionLine(text, "online", e.online.detection, true);
  print(text, "  (online: recall from a label's fifth visible frame on)\n");
  printFrames(text, "false rows, final", "track", e.final.detection.false_in);
  printFrames(text, "missed to 30 m, final", "label", e.final.detection.missed_in);
}

nlohmann::ordered_json jsonOf(const DetectionErrors& errors) {
  return {{"within_30m", jsonOf(errors.within_30m)},
          {"from_30_to_50m", jsonOf(errors.from_30_to_50m)},
          {"within_30m_from_fifth_frame", jsonOf(errors.within_30m_from_fifth)},
          {"from_30_to_50m_from_fifth_frame", jsonOf(errors.from_30_to_50m_from_fifth)},
          {"rows", errors.rows},
          {"false_rows", errors.false_rows},
          {"false_rows_unlabeled", errors.false_rows_unlabeled},
          {"false_rows_in_dont_care", errors.false_rows_in_ignored},
          {"id_switches", errors.id_switches},
          {"mota", errors.mota},
          {"false_in", jsonOf(errors.false_in)},
          {"missed_within_30m_in", jsonOf(errors.missed_in)}};
}

}  // namespace motorcade
