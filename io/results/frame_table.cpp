#include "io/results/frame_table.hpp"

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

/// Reads the columns that were added in later versions.
void readWaits(FieldReader& fields, FrameRow& row) {
  row.has_waits = true;
  row.entry_wait_ms = fields.number("entry_wait_ms");
  for (auto& stage : row.stages) stage.wait_ms = fields.number("wait_ms");
  row.publish_wait_ms = fields.number("publish_wait_ms");
  for (auto& stage : row.stages) stage.cpu_ms = fields.number("cpu_ms");
  row.points = static_cast<int>(fields.integer("points"));
  row.inliers = static_cast<int>(fields.integer("inliers"));
  row.objects = static_cast<int>(fields.integer("objects"));
}

FrameRow readFrame(FieldReader& fields) {
  FrameRow row;
  row.head.frame.value = fields.integer("frame");
  row.head.status = fields.byName("status", kStatuses, writtenName).status;
  row.head.stamp.ns = fields.integer("stamp_ns");
  row.latency_ms = fields.number("latency_ms");
  row.decode_ms = fields.number("decode_ms");
  for (std::size_t stage = 0; stage < kStageCount; ++stage)
    row.stages[stage].work_ms = fields.number(kStageKeys[stage]);
  if (fields.atEnd()) return row;  // files of the first versions end here
  row.head.cause = fields.byName("cause", kCauses, causeName);
  row.head.segment = static_cast<int>(fields.integer("segment"));
  if (!fields.atEnd()) readWaits(fields, row);
  return row;
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
  for (const auto& line : readTable(file, "frame,status,stamp_ns,latency_ms")) {
    FieldReader fields(file, line, ',');
    rows.push_back(readFrame(fields));
  }
  return rows;
}

}  // namespace motorcade
