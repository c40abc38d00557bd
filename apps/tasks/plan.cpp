#include "apps/tasks/plan.hpp"

#include <algorithm>
#include <array>
#include <map>
#include <string_view>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/pipeline/toml_document.hpp"
#include "apps/tasks/task_json.hpp"
#include "io/files/errors.hpp"
#include "io/files/line_file.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostFigures_bytes = std::size_t{1} << 24;
constexpr std::array<std::string_view, 9> kKeys{"dataset", "method", "measure", "unit", "source",
                                                "note",    "values", "mean_of", "value"};
/// Units, and the endings of measures' names in each.
constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kUnits{
    {{"m", "_m"}, {"deg", "_deg"}, {"percent", "_percent"}, {"deg/m", "_deg_per_m"}}};

/// Reads the number of frames of each drive of a data set from the table [frames.DATASET]; empty without one.
std::map<std::string, int> frameCounts(const toml::table& document, const std::string& dataset, const fs::path& file) {
  std::map<std::string, int> counts;
  const toml::table* const table = document["frames"][dataset].as_table();
  if (table == nullptr) return counts;
  for (const auto& [drive, node] : *table) {
    const auto count = node.value_exact<std::int64_t>();
    if (!count || *count < 1)
      failAt({file.string(), drive.source().begin.line},
             fmt::format("'{}' must be a number of frames", printable(drive.str())));
    counts[std::string(drive.str())] = static_cast<int>(*count);
  }
  return counts;
}

/// Takes the keys of a [[figures]] table; each failure is a UsageError that names line and key.
class FigureReader {
 public:
  FigureReader(const toml::table& table, const fs::path& file)
      : table_(table), position_{file.string(), table.source().begin.line} {
    for (const auto& [key, node] : table)
      if (std::ranges::find(kKeys, key.str()) == kKeys.end())
        fail(fmt::format("unknown key '{}'", printable(key.str())));
  }

  std::string text(std::string_view key) const {
    const auto value = table_[key].value_exact<std::string>();
    if (!value || trimmed(*value).empty()) fail("needs '" + std::string(key) + "', a text in quotes");
    return *value;
  }

  /// The figure without drives and value.
  PublishedFigure common() const {
    PublishedFigure figure{.method = text("method"), .measure = text("measure"), .source = text("source")};
    if (table_.contains("note")) figure.note = text("note");
    requireUnit(figure.measure);
    return figure;
  }

  std::vector<PublishedFigure> figures() const {
    const toml::table* const values = table_["values"].as_table();
    const toml::array* const mean_of = table_["mean_of"].as_array();
    if ((values == nullptr) == (mean_of == nullptr))
      fail("needs either 'values' = { \"DRIVE\" = NUMBER, ... } or 'mean_of' = [\"DRIVE\", ...] with 'value' = NUMBER");
    return values != nullptr ? figuresOf(*values) : std::vector{meanOf(*mean_of)};
  }

 private:
  std::vector<PublishedFigure> figuresOf(const toml::table& values) const {
    std::vector<PublishedFigure> figures;
    for (const auto& [drive, node] : values) {
      figures.push_back(common());
      figures.back().drives = {std::string(drive.str())};
      figures.back().value = number(node, std::string(drive.str()));
    }
    return figures;
  }

  PublishedFigure meanOf(const toml::array& drives) const {
    PublishedFigure figure = common();
    for (const auto& drive : drives) figure.drives.push_back(drive.value_or(std::string()));
    if (figure.drives.size() < 2 || std::ranges::count(figure.drives, "") > 0)
      fail("'mean_of' needs the names of two drives at least");
    const toml::node* const value = table_.get("value");
    if (value == nullptr) fail("needs 'value', the mean");
    figure.value = number(*value, "value");
    return figure;
  }

  double number(const toml::node& node, const std::string& key) const {
    const auto value = node.value<double>();
    if (!value || !node.is_number()) fail(fmt::format("'{}' must be a number", printable(key)));
    return *value;
  }

  void requireUnit(const std::string& measure) const {
    const std::string unit = text("unit");
    const auto* const known = std::ranges::find(kUnits, unit, &decltype(kUnits)::value_type::first);
    if (known == kUnits.end()) fail("'unit' is " + printable(unit) + "; write m, deg, percent or deg/m");
    if (!measure.ends_with(known->second))
      fail("'measure' is " + printable(measure) + ", whose name does not end with " + std::string(known->second) +
           ", as one in " + unit + " does");
  }

  [[noreturn]] void fail(const std::string& message) const { failAt(position_, message); }

  const toml::table& table_;
  TomlPosition position_;
};

std::string contentOfFigures(const fs::path& file) {
  try {
    return readWhole(file, kMostFigures_bytes);
  } catch (const InputError& error) {
    throw UsageError(error.what());
  }
}

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

std::vector<PublishedFigure> readPublishedFigures(const fs::path& file, const std::string& dataset) {
  const toml::table document = parseToml(contentOfFigures(file), file.string());
  const toml::array* const list = document["figures"].as_array();
  if (list == nullptr) throw UsageError(file.string() + ": has no [[figures]]");
  const auto counts = frameCounts(document, dataset, file);
  std::vector<PublishedFigure> figures;
  for (const auto& node : *list) {
    const toml::table* const table = node.as_table();
    if (table == nullptr) throw UsageError(file.string() + ": write [[figures]] for each");
    const FigureReader reader(*table, file);
    const bool ours = reader.text("dataset") == dataset;
    for (PublishedFigure& figure : reader.figures())
      if (ours) figures.push_back(std::move(figure));
  }
  for (PublishedFigure& figure : figures)
    for (const std::string& drive : figure.drives) {
      const auto count = counts.find(drive);
      figure.frames.push_back(count == counts.end() ? 0 : count->second);
    }
  return figures;
}

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
