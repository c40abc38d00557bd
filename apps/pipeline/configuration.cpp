#include "apps/pipeline/configuration.hpp"

#include <algorithm>
#include <charconv>
#include <optional>
#include <utility>

#include "apps/pipeline/toml_document.hpp"
#include "core/edit_distance.hpp"
#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

constexpr std::size_t kMaxFile_bytes = std::size_t{1} << 18, kMostKeyCharacters = 80;

/// A key of the right name in another section is nearer than a misspelled one.
std::string nearestKey(const std::vector<ConfigurationKey>& table, const std::string& key) {
  const std::string name = key.substr(key.find_last_of('.') + 1);
  const auto distance = [&](const ConfigurationKey& known) {
    return known.parameter.name == name
               ? 0
               : editDistance(std::string_view(key).substr(0, kMostKeyCharacters), known.key());
  };
  return std::ranges::min_element(table, {}, distance)->key();
}

/// Sets one parameter; false when the value is of the wrong type or out of range.
struct Assign {
  const Parameter& parameter;
  const toml::node& node;

  bool operator()(int* target) const {
    const auto value = node.value_exact<std::int64_t>();
    if (!value || !std::in_range<int>(*value) || !parameter.accepts(static_cast<double>(*value))) return false;
    *target = static_cast<int>(*value);
    return true;
  }
  bool operator()(double* target) const {
    const auto value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value || !parameter.accepts(*value)) return false;
    *target = *value;
    return true;
  }
  bool operator()(bool* target) const {
    const auto value = node.value_exact<bool>();
    if (value) *target = *value;
    return value.has_value();
  }
  bool operator()(const Choice& choice) const {
    const auto name = node.value_exact<std::string>();
    const auto found = name ? std::ranges::find(choice.names, *name) : choice.names.end();
    if (found == choice.names.end()) return false;
    choice.set(static_cast<std::size_t>(found - choice.names.begin()));
    return true;
  }
};

std::string nodeText(const toml::node& node) {
  std::ostringstream text;
  node.visit([&](const auto& value) { text << value; });
  return text.str();
}

void applyValue(const std::vector<ConfigurationKey>& table, std::string key, const toml::node& node,
                const TomlPosition& position) {
  if (key == "backend") key = "backend.kind";
  const auto known = std::ranges::find(table, key, &ConfigurationKey::key);
  if (known == table.end())
    failAt(position,
           "unknown key '" + printable(key, kMostKeyCharacters) + "'; did you mean '" + nearestKey(table, key) + "'?");
  const Parameter& parameter = known->parameter;
  if (std::visit(Assign{parameter, node}, parameter.value)) return;
  const bool whole = std::holds_alternative<int*>(parameter.value);
  failAt(position, "'" + key + "' is " + printable(nodeText(node)) + "; write " + (whole ? "a whole number, " : "") +
                       parameter.allowed());
}

void applyTable(const std::vector<ConfigurationKey>& table, const toml::table& values, const std::string& prefix,
                const std::string& file) {
  for (const auto& [name, node] : values) {
    const std::string key = prefix + std::string(name.str());
    if (const toml::table* section = node.as_table())
      applyTable(table, *section, key + ".", file);
    else
      applyValue(table, key, node, {file, node.source().begin.line});
  }
}

std::string numberToml(double value) {
  char digits[32];
  const auto end = std::to_chars(digits, std::end(digits), value).ptr;
  std::string text(digits, end);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

struct ToToml {
  std::string operator()(const int* value) const { return std::to_string(*value); }
  std::string operator()(const double* value) const { return numberToml(*value); }
  std::string operator()(const bool* value) const { return *value ? "true" : "false"; }
  std::string operator()(const Choice& choice) const { return '"' + choice.names[choice.get()] + '"'; }
};

}  // namespace

void applyToml(PipelineConfig& config, std::string_view toml, const std::string& file_name) {
  applyTable(parameterTable(config), parseToml(toml, file_name), "", file_name);
}

void applyFile(PipelineConfig& config, const std::filesystem::path& file) {
  std::string text;
  try {
    text = readWhole(file, kMaxFile_bytes);
  } catch (const InputError& error) {
    throw UsageError(error.what());
  }
  applyToml(config, text, file.string());
}

void applyAssignment(PipelineConfig& config, const std::string& assignment) {
  const std::string name = "--set " + assignment;
  const auto equals = assignment.find('=');
  if (equals == std::string::npos) throw UsageError(name + ": write key=value");
  const std::string key = assignment.substr(0, equals);
  const auto table = parameterTable(config);
  const auto value = [&](const std::string& text) -> std::optional<toml::table> {
    try {
      return parseToml("value = " + text, name);
    } catch (const UsageError&) {
      return std::nullopt;
    }
  };
  const std::string text = assignment.substr(equals + 1);
  auto assigned = value(text);
  if (!assigned) assigned = value('"' + text + '"');
  if (!assigned || assigned->size() != 1)
    throw UsageError(name + ": the value is neither a number, true, false nor a name");
  applyValue(table, key, *assigned->get("value"), {name});
}

std::string toToml(const PipelineConfig& config) {
  PipelineConfig copy = config;  // the table binds to members that may be set
  std::string text, section;
  for (const auto& [key_section, parameter] : parameterTable(copy)) {
    if (key_section != section) {
      text += (text.empty() ? "[" : "\n[") + key_section + "]\n";
      section = key_section;
    }
    text += "# " + parameter.gain + "; " + parameter.allowed() + "\n";
    text += parameter.name + " = " + std::visit(ToToml{}, parameter.value) + "\n";
  }
  return text;
}

}  // namespace motorcade
