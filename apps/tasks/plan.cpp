#include "apps/tasks/plan.hpp"

#include <nlohmann/json.hpp>

#include "apps/tasks/task_json.hpp"
#include "io/files/errors.hpp"
#include "io/files/line_file.hpp"

namespace motorcade {
namespace {

constexpr int kFormat = 1;

Json jsonOf(const Task& task) {
  return {{"name", task.name},
          {"drive", task.drive},
          {"set", task.set},
          {"seed", orNull(task.seed)},
          {"repetition", task.repetition},
          {"sequence", task.sequence.string()},
          {"render_arguments", task.render_arguments},
          {"run_arguments", task.run_arguments},
          {"evaluate_arguments", task.evaluate_arguments},
          {"frames", task.frames},
          {"has_truth", task.has_truth},
          {"threads", task.threads},
          {"fingerprint", task.fingerprint},
          {"problem", task.problem}};
}

Task taskOf(const Json& json) {
  return {.name = json.at("name"),
          .drive = json.at("drive"),
          .set = json.at("set"),
          .seed = seedOf(json),
          .repetition = json.at("repetition"),
          .sequence = json.at("sequence").get<std::string>(),
          .render_arguments = json.at("render_arguments"),
          .run_arguments = json.at("run_arguments"),
          .evaluate_arguments = json.at("evaluate_arguments"),
          .frames = json.at("frames"),
          .has_truth = json.value("has_truth", false),
          .threads = json.at("threads"),
          .fingerprint = json.at("fingerprint"),
          .problem = json.at("problem")};
}

Json jsonOf(const PublishedFigure& figure) {
  return {{"method", figure.method}, {"measure", figure.measure}, {"drives", figure.drives}, {"frames", figure.frames},
          {"value", figure.value},   {"source", figure.source},   {"note", figure.note}};
}

PublishedFigure figureOf(const Json& json) {
  return {.method = json.at("method"),
          .measure = json.at("measure"),
          .drives = json.at("drives"),
          .frames = json.at("frames"),
          .value = json.at("value"),
          .source = json.at("source"),
          .note = json.at("note")};
}

Plan planOf(const Json& json) {
  if (json.at("format") != kFormat) throw InputError("is the plan of a batch by another version of motorcade");
  Plan plan{.manifest = json.at("manifest").get<std::string>(),
            .program = json.at("program").get<std::string>(),
            .program_stamp = json.value("program_stamp", ""),
            .baseline_set = json.at("baseline_set")};
  for (const Json& task : json.at("tasks")) plan.tasks.push_back(taskOf(task));
  for (const Json& drive : json.value("left_out", Json::array()))
    plan.left_out.push_back({drive.at("name"), drive.at("looked_for")});
  for (const Json& figure : json.value("published", Json::array())) plan.published.push_back(figureOf(figure));
  return plan;
}

}  // namespace

void writePlan(const std::filesystem::path& file, const Plan& plan) {
  Json tasks = Json::array(), left_out = Json::array(), published = Json::array();
  for (const Task& task : plan.tasks) tasks.push_back(jsonOf(task));
  for (const LeftOutDrive& drive : plan.left_out)
    left_out.push_back({{"name", drive.name}, {"looked_for", drive.looked_for}});
  for (const PublishedFigure& figure : plan.published) published.push_back(jsonOf(figure));
  const Json json = {{"format", kFormat},
                     {"manifest", plan.manifest.string()},
                     {"program", plan.program.string()},
                     {"program_stamp", plan.program_stamp},
                     {"baseline_set", plan.baseline_set},
                     {"tasks", std::move(tasks)},
                     {"left_out", std::move(left_out)},
                     {"published", std::move(published)}};
  writeAtOnce(file, textOf(json));
}

Plan readPlan(const std::filesystem::path& file) {
  return readJson<Plan>(file, "the plan of a batch; run `motorcade batch MANIFEST --out` anew", planOf);
}

}  // namespace motorcade
