#include "apps/view/recorded_files.hpp"

#include <algorithm>
#include <cstdlib>
#include <string_view>

#include <nlohmann/json.hpp>

#include "io/files/json_text.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;
using FileJson = nlohmann::json;

std::vector<std::string> fieldsOf(std::string_view line) {
  std::vector<std::string> fields;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    fields.emplace_back(line.substr(begin, end - begin));
    begin = end + 1;
  }
  return fields;
}

/// The number in the column of that name; 0 where there is none.
double numberIn(const std::vector<std::string>& header, const std::vector<std::string>& fields,
                const std::string& name) {
  const auto column = std::ranges::find(header, name) - header.begin();
  return column < std::ssize(fields) ? std::strtod(fields[static_cast<std::size_t>(column)].c_str(), nullptr) : 0;
}

}  // namespace

std::map<std::int64_t, ShownTiming> readTimings(const fs::path& run_folder) {
  std::map<std::int64_t, ShownTiming> timings;
  const auto lines = readLines(run_folder / "frames.csv", LastLine::kDropIfCut);
  if (lines.empty()) return timings;
  const auto header = fieldsOf(lines.front().text);
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const auto fields = fieldsOf(lines[i].text);
    const auto number = [&](const std::string& name) { return numberIn(header, fields, name); };
    ShownTiming timing{.latency_ms = number("latency_ms"), .decode_ms = number("decode_ms")};
    for (std::size_t stage = 0; stage < kStageCount; ++stage)
      timing.stages_ms[stage] = number(std::string(kStageKeys[stage]) + "_ms");
    timings[static_cast<std::int64_t>(number("frame"))] = timing;
  }
  return timings;
}

std::map<std::int64_t, std::vector<std::string>> readOutlineLines(const fs::path& run_folder) {
  std::map<std::int64_t, std::vector<std::string>> outlines;
  const fs::path file = run_folder / "outlines.jsonl";
  if (!fs::exists(file)) return outlines;
  constexpr std::string_view kStart = R"({"frame":)";
  for (TextLine& line : readLines(file, LastLine::kDropIfCut))
    if (line.text.starts_with(kStart))
      outlines[std::strtoll(line.text.c_str() + kStart.size(), nullptr, 10)].push_back(std::move(line.text));
  return outlines;
}

ShownOutline outlineOf(const std::string& line) {
  const FileJson json = jsonOrDiscarded(line);
  if (!json.is_object() || !json.contains("track_id") || !json.contains("polygons")) return {};
  ShownOutline outline;
  try {
    outline.track = {json["track_id"].get<std::int64_t>()};
    for (const FileJson& polygon : json["polygons"]) {
      Polygon& corners = outline.polygons.emplace_back();
      for (const FileJson& corner : polygon) corners.emplace_back(corner.at(0).get<int>(), corner.at(1).get<int>());
    }
  } catch (const FileJson::exception&) {
    return {};
  }
  return outline;
}

}  // namespace motorcade
