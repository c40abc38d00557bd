#include "apps/tasks/published_figures.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "apps/pipeline/toml_document.hpp"
#include "io/files/errors.hpp"
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

}  // namespace motorcade
