#include "apps/pipeline/configuration.hpp"

#include <algorithm>
#include <charconv>
#include <numeric>
#include <optional>
#include <vector>

#define TOML_HEADER_ONLY 1
#include <toml++/toml.h>

#include "apps/pipeline/parameter_table.hpp"
#include "io/errors.hpp"
#include "io/text_file.hpp"

namespace motorcade {
namespace {

/// Where a value stands, for messages.
struct Position {
  std::string file;
  toml::source_index line = 0;
  std::string text() const { return line > 0 ? file + ", line " + std::to_string(line) : file; }
};

[[noreturn]] void fail(const Position& position, const std::string& message) {
  throw UsageError(position.text() + ": " + message);
}

/// Levenshtein's distance: how many letters to change, to add or to take away.
std::size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row[b.size()];
}

/// A key of the right name in another section is nearer than a misspelled one.
std::string nearestKey(const std::vector<ConfigurationKey>& table, const std::string& key) {
  const std::string name = key.substr(key.find_last_of('.') + 1);
  const auto distance = [&](const ConfigurationKey& known) {
    return known.parameter.name == name ? 0 : editDistance(key, known.key());
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
                const Position& position) {
  if (key == "backend") key = "backend.kind";
  const auto known = std::ranges::find(table, key, &ConfigurationKey::key);
  if (known == table.end()) fail(position, "unknown key '" + key + "'; did you mean '" + nearestKey(table, key) + "'?");
  const Parameter& parameter = known->parameter;
  if (std::visit(Assign{parameter, node}, parameter.value)) return;
  const bool whole = std::holds_alternative<int*>(parameter.value);
  fail(position,
       "'" + key + "' is " + nodeText(node) + "; write " + (whole ? "a whole number, " : "") + parameter.allowed());
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
  toml::table values;
  try {
    values = toml::parse(toml, file_name);
  } catch (const toml::parse_error& error) {
    fail({file_name, error.source().begin.line}, "is no TOML: " + std::string(error.description()));
  }
  applyTable(parameterTable(config), values, "", file_name);
}

void applyFile(PipelineConfig& config, const std::filesystem::path& file) {
  std::string text;
  try {
    text = readWhole(file);
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
      return toml::parse("value = " + text);
    } catch (const toml::parse_error&) {
      return std::nullopt;
    }
  };
  const std::string text = assignment.substr(equals + 1);
  auto parsed = value(text);
  if (!parsed) parsed = value('"' + text + '"');
  if (!parsed || parsed->size() != 1)
    throw UsageError(name + ": the value is neither a number, true, false nor a name");
  applyValue(table, key, *parsed->get("value"), {name});
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
