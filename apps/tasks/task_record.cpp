#include "apps/tasks/task_record.hpp"

#include <unistd.h>

#include "apps/tasks/task_json.hpp"
#include "io/files/line_file.hpp"

namespace motorcade {

std::string hostName() {
  char name[256] = {};
  return ::gethostname(name, sizeof(name) - 1) == 0 ? name : "unknown";
}

namespace {

Json jsonOf(const TaskFailure& failure) {
  return {{"step", failure.step},
          {"message", failure.message},
          {"exit_code", failure.exit_code},
          {"signal", failure.signal},
          {"last_lines", failure.last_lines}};
}

TaskFailure failureOf(const Json& json) {
  return {.step = json.at("step"),
          .message = json.at("message"),
          .exit_code = json.at("exit_code"),
          .signal = json.at("signal"),
          .last_lines = json.at("last_lines")};
}

TaskRecord recordOfJson(const Json& json) {
  TaskRecord record{.task = json.at("task"),
                    .drive = json.at("drive"),
                    .set = json.at("set"),
                    .seed = seedOf(json),
                    .repetition = json.at("repetition"),
                    .sequence = json.at("sequence").get<std::string>(),
                    .fingerprint = json.at("fingerprint"),
                    .rendering = json.value("rendering", ""),
                    .host = json.at("host"),
                    .processors = json.at("processors"),
                    .started = json.at("started"),
                    .wall_s = json.at("wall_s"),
                    .cpu_s = json.at("cpu_s"),
                    .peak_memory_bytes = json.at("peak_memory_bytes")};
  if (const Json& failure = json.at("failure"); !failure.is_null()) record.failure = failureOf(failure);
  return record;
}

}  // namespace

void writeTaskRecord(const std::filesystem::path& file, const TaskRecord& record) {
  const Json json = {{"task", record.task},
                     {"drive", record.drive},
                     {"set", record.set},
                     {"seed", orNull(record.seed)},
                     {"repetition", record.repetition},
                     {"sequence", record.sequence.string()},
                     {"fingerprint", record.fingerprint},
                     {"rendering", record.rendering},
                     {"host", record.host},
                     {"processors", record.processors},
                     {"started", record.started},
                     {"wall_s", record.wall_s},
                     {"cpu_s", record.cpu_s},
                     {"peak_memory_bytes", record.peak_memory_bytes},
                     {"failure", record.failure ? jsonOf(*record.failure) : Json()}};
  writeAtOnce(file, textOf(json));
}

TaskRecord readTaskRecord(const std::filesystem::path& file) {
  return readJson<TaskRecord>(file, "the record of a task", recordOfJson);
}

}  // namespace motorcade
