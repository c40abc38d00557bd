#include "io/results/frame_table.hpp"

#include <functional>
#include <map>
#include <utility>

#include "io/files/number_text.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

/// A frame's status as it is written: a good frame with a cause is degraded.
struct WrittenStatus {
  FrameStatus status = FrameStatus::kGood;
  bool degraded = false;
};
constexpr std::array kStatuses = {WrittenStatus{FrameStatus::kGood}, WrittenStatus{FrameStatus::kGood, true},
                                  WrittenStatus{FrameStatus::kLost}, WrittenStatus{FrameStatus::kRejected},
                                  WrittenStatus{FrameStatus::kDropped}};
std::string_view writtenName(WrittenStatus written) {
  return written.degraded ? "degraded" : statusName(written.status);
}
constexpr std::array kCauses = {FrameCause::kNone,         FrameCause::kAfterGap,   FrameCause::kFewPoints,
                                FrameCause::kNothingFound, FrameCause::kUnlinked,   FrameCause::kFailed,
                                FrameCause::kUnusable,     FrameCause::kOutOfOrder, FrameCause::kTooLate};
constexpr std::array<std::string_view, kCauseCount> kCauseNames = {
    "none", "after_gap", "few_points", "nothing_found", "unlinked", "failed", "unusable", "out_of_order", "too_late"};

void readColumn(FieldReader& fields, std::string_view name, double& time_ms) { time_ms = fields.number(name); }
void readColumn(FieldReader& fields, std::string_view name, std::int64_t& number) { number = fields.integer(name); }
void readColumn(FieldReader& fields, std::string_view name, int& count) {
  count = static_cast<int>(fields.integer(name));
}
void readColumn(FieldReader& fields, std::string_view name, FrameStatus& status) {
  status = fields.byName(name, kStatuses, writtenName).status;
}
void readColumn(FieldReader& fields, std::string_view name, FrameCause& cause) {
  cause = fields.byName(name, kCauses, causeName);
}

/// Reads the field of the column of that name into a row.
using ColumnReader = std::function<void(FieldReader&, std::string_view name, FrameRow&)>;

/// The readers of all columns, by their names in the header.
std::map<std::string, ColumnReader, std::less<>> columnReaders() {
  std::map<std::string, ColumnReader, std::less<>> readers;
  const auto add = [&readers](const std::string& name, auto place) {
    readers[name] = [place](FieldReader& fields, std::string_view column, FrameRow& row) {
      readColumn(fields, column, std::invoke(place, row));
    };
  };
  add("frame", [](FrameRow& row) -> std::int64_t& { return row.head.frame.value; });
  add("status", [](FrameRow& row) -> FrameStatus& { return row.head.status; });
  add("stamp_ns", [](FrameRow& row) -> std::int64_t& { return row.head.stamp.ns; });
  add("latency_ms", &FrameRow::latency_ms);
  add("decode_ms", &FrameRow::decode_ms);
  add("cause", [](FrameRow& row) -> FrameCause& { return row.head.cause; });
  add("segment", [](FrameRow& row) -> int& { return row.head.segment; });
  add("entry_wait_ms", &FrameRow::entry_wait_ms);
  add("publish_wait_ms", &FrameRow::publish_wait_ms);
  for (std::size_t i = 0; i < kStageCount; ++i) {
    const std::string stage(kStageKeys[i]);
    add(stage + "_ms", [i](FrameRow& row) -> double& { return row.stages[i].work_ms; });
    add(stage + "_wait_ms", [i](FrameRow& row) -> double& { return row.stages[i].wait_ms; });
    add(stage + "_cpu_ms", [i](FrameRow& row) -> double& { return row.stages[i].cpu_ms; });
  }
  add("points", &FrameRow::points);
  add("inliers", &FrameRow::inliers);
  add("objects", &FrameRow::objects);
  return readers;
}

}  // namespace

std::string_view statusName(FrameStatus status) {
  switch (status) {
    case FrameStatus::kGood:
      return "good";
    case FrameStatus::kLost:
      return "lost";
    case FrameStatus::kRejected:
      return "rejected";
    case FrameStatus::kDropped:
      return "dropped";
  }
  return "good";
}

std::string_view causeName(FrameCause cause) { return kCauseNames[static_cast<std::size_t>(cause)]; }

std::string framesHeader() {
  std::string header("frame,status,stamp_ns,latency_ms,decode_ms");
  for (const auto& stage : kStageKeys) header.append(",").append(stage).append("_ms");
  header.append(",cause,segment,entry_wait_ms");
  for (const auto& stage : kStageKeys) header.append(",").append(stage).append("_wait_ms");
  header.append(",publish_wait_ms");
  for (const auto& stage : kStageKeys) header.append(",").append(stage).append("_cpu_ms");
  return header.append(",points,inliers,objects");
}

std::string frameLine(const FrameTiming& timing) {
  std::string line;
  line.reserve(256);
  appendInteger(line, timing.head.frame.value);
  line += ',';
  const bool degraded = timing.head.status == FrameStatus::kGood && timing.head.cause != FrameCause::kNone;
  line += writtenName({timing.head.status, degraded});
  line += ',';
  appendInteger(line, timing.head.stamp.ns);
  const auto add = [&](double value_ms) {
    line += ',';
    appendFixed(line, value_ms, 3);
  };
  add(timing.latency_ms());
  add(timing.decode_ms);
  for (const StageSpan& span : timing.stages) add(span.duration_ms());
  line += ',';
  line += causeName(timing.head.cause);
  line += ',';
  appendInteger(line, timing.head.segment);
  add(timing.entry_wait_ms());
  for (std::size_t stage = 0; stage < kStageCount; ++stage) add(timing.wait_ms(static_cast<Stage>(stage)));
  add(timing.publish_wait_ms());
  for (const StageSpan& span : timing.stages) add(span.cpu_ms);
  for (const int count : {timing.points, timing.inliers, timing.objects}) {
    line += ',';
    appendInteger(line, count);
  }
  return line;
}

std::vector<FrameRow> readFrames(const std::filesystem::path& file) {
  std::vector<FrameRow> rows;
  if (!std::filesystem::exists(file)) return rows;
  const auto lines = readTableWithHeader(file, "frame,status,stamp_ns,latency_ms");
  if (lines.empty()) return rows;
  const auto readers = columnReaders();
  std::vector<std::pair<std::string_view, const ColumnReader*>> columns;  // without a reader: of another version
  bool has_waits = false;
  for (FieldReader header(file, lines.front(), ','); !header.atEnd();) {
    const std::string_view name = header.word("column");
    const auto reader = readers.find(name);
    columns.emplace_back(name, reader == readers.end() ? nullptr : &reader->second);
    has_waits |= name == "entry_wait_ms";
  }
  for (auto line = lines.begin() + 1; line != lines.end(); ++line) {
    FieldReader fields(file, *line, ',');
    FrameRow& row = rows.emplace_back();
    row.has_waits = has_waits;
    for (const auto& [name, read] : columns) {
      if (read)
        (*read)(fields, name, row);
      else
        fields.word(name);
    }
  }
  return rows;
}

}  // namespace motorcade
