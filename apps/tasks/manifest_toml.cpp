#include <sstream>
#include <utility>

#include "apps/pipeline/toml_document.hpp"
#include "apps/tasks/manifest_fields.hpp"
#include "apps/tasks/path_text.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

constexpr const char* kForm =
    "; a manifest has root, baseline_set, dataset, published, [defaults], [sets.NAME] and [[drives]]";

std::string wordOf(const toml::node& node) {
  if (const auto text = node.value_exact<std::string>()) return *text;
  std::ostringstream text;
  node.visit([&](const auto& value) { text << value; });
  return text.str();
}

/// The position of a key, or of an element of a list. A table that dotted keys make has none of its own.
TomlPosition positionOf(const auto& key_or_element, const std::filesystem::path& file) {
  return {file.string(), key_or_element.source().begin.line};
}

std::string stringOf(const toml::node& node, const toml::key& key, const std::filesystem::path& file) {
  const auto text = node.value_exact<std::string>();
  if (!text) failAt(positionOf(key, file), "'" + std::string(key.str()) + "' must be a text in quotes");
  return *text;
}

const toml::array& listOf(const toml::node& node, const toml::key& key, const std::filesystem::path& file) {
  const toml::array* const list = node.as_array();
  if (list == nullptr) failAt(positionOf(key, file), "'" + std::string(key.str()) + "' is no list" + kForm);
  return *list;
}

/// Adds the keys of a table, each with its values as words.
void addFields(ManifestFields& fields, const toml::table& table, const std::filesystem::path& file) {
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    if (node.is_table())
      failAt(positionOf(key, file), "'" + printable(name) + "' is a table; parameters stand in [sets.NAME]");
    auto& words = fields.words[name];
    words.clear();
    if (const toml::array* const values = node.as_array())
      for (const auto& value : *values) words.push_back(wordOf(value));
    else
      words.push_back(wordOf(node));
  }
}

void addAssignments(ParameterSet& set, const toml::table& table, const std::string& prefix) {
  for (const auto& [key, node] : table) {
    const std::string name = prefix + std::string(key.str());
    if (const toml::table* const section = node.as_table())
      addAssignments(set, *section, name + ".");
    else
      set.assignments.push_back(name + "=" + wordOf(node));
  }
}

/// Sets in the order of the file, which a TOML table does not keep.
std::vector<ParameterSet> setsOf(const toml::table& table, const std::filesystem::path& file) {
  std::map<std::pair<toml::source_index, toml::source_index>, ParameterSet> by_place;
  for (const auto& [key, node] : table) {
    const TomlPosition position = positionOf(key, file);
    const toml::table* const parameters = node.as_table();
    if (parameters == nullptr) failAt(position, "a set of parameters is a table: [sets.NAME]");
    ParameterSet set{.name = std::string(key.str())};
    requireName(set.name, position.text());
    addAssignments(set, *parameters, "");
    by_place[{key.source().begin.line, key.source().begin.column}] = std::move(set);
  }
  std::vector<ParameterSet> sets;
  for (auto& [place, set] : by_place) sets.push_back(std::move(set));
  return sets;
}

void addEntries(Manifest& manifest, const toml::array& drives, const toml::table& defaults) {
  for (const auto& node : drives) {
    const TomlPosition position = positionOf(node, manifest.file);
    const toml::table* const table = node.as_table();
    if (table == nullptr) failAt(position, std::string("a drive is a table") + kForm);
    ManifestFields fields{.where = position.text()};
    addFields(fields, defaults, manifest.file);
    addFields(fields, *table, manifest.file);
    for (ManifestEntry& entry : manifestEntries(fields)) manifest.entries.push_back(std::move(entry));
  }
}

}  // namespace

Manifest readManifestToml(const std::filesystem::path& file, const std::string& text) {
  const toml::table document = parseToml(text, file.string());
  Manifest manifest{.file = file};
  toml::table defaults;
  const toml::array* drives = nullptr;
  for (const auto& [key, node] : document) {
    const std::string name(key.str());
    const toml::table* const table = node.as_table();
    if (name == "root")
      manifest.root = stringOf(node, key, file);
    else if (name == "baseline_set")
      manifest.baseline_set = stringOf(node, key, file);
    else if (name == "dataset")
      manifest.dataset = stringOf(node, key, file);
    else if (name == "published")
      manifest.published = file.parent_path() / expandedPath(stringOf(node, key, file));
    else if (name == "drives")
      drives = &listOf(node, key, file);
    else if (name == "defaults" && table != nullptr)
      defaults = *table;
    else if (name == "sets" && table != nullptr)
      manifest.sets = setsOf(*table, file);
    else
      failAt(positionOf(key, file), "unknown key '" + printable(name) + "'" + kForm);
  }
  if (drives != nullptr) addEntries(manifest, *drives, defaults);
  return manifest;
}

}  // namespace motorcade
