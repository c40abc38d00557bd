#include "apps/pipeline/configuration.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <optional>
#include <stdexcept>
#include <vector>

// What toml++ takes for granted is an assertion without NDEBUG, with it undefined behavior; and version 3.3 errs, in
// times of day for one.
#pragma push_macro("NDEBUG")
#undef NDEBUG
namespace motorcade {
[[noreturn]] static void failInParser(const char* what) { throw std::logic_error(what); }
}  // namespace motorcade
#define TOML_ASSERT(holds) (static_cast<bool>(holds) ? void() : motorcade::failInParser(#holds))
#define TOML_HEADER_ONLY 1
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")

#include "apps/pipeline/parameter_table.hpp"
#include "core/edit_distance.hpp"
#include "io/errors.hpp"
#include "io/text_file.hpp"

namespace motorcade {
namespace {

constexpr std::size_t kMaxFile_bytes = std::size_t{1} << 18, kMostKeyCharacters = 80;

/// Where a value stands, for messages.
struct Position {
  std::string file;
  toml::source_index line = 0;
  std::string text() const { return line > 0 ? file + ", line " + std::to_string(line) : file; }
};

[[noreturn]] void fail(const Position& position, const std::string& message) {
  throw UsageError(position.text() + ": " + message);
}

/// How many names a key on this line may have at most: dots, those in a row counting once.
int namesOn(std::string_view line) {
  int names = 0;
  char before = '.';
  for (const char c : line) {
    if (c == '.' && before != '.') ++names;
    if (c != ' ' && c != '\t') before = c;
  }
  return names;
}

/// Refuses what toml++ cannot stand: letters beyond ASCII in a key (undefined behavior in 3.3), tables one in the other
/// by the thousand, which overflow the stack, and headers whose name begins with what no name may begin with.
void requireParsable(std::string_view line, const Position& position) {
  constexpr int kMostNames = 100;  // our keys have three
  const auto begins_name = [](unsigned char c) {
    return std::isalnum(c) != 0 || std::string_view("_-\"']").find(static_cast<char>(c)) != std::string_view::npos;
  };
  if (std::ranges::any_of(line.substr(0, line.find('#')), [](unsigned char c) { return c > 127; }))
    fail(position, "has a letter that is not ASCII; only comments may");
  if (namesOn(line) > kMostNames) fail(position, "has more than 100 dots; no key has as many");
  line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
  if (!line.starts_with('[')) return;
  line.remove_prefix(std::min(line.find_first_not_of("[ \t"), line.size()));
  if (line.empty() || !begins_name(line.front())) fail(position, "a section's name must begin with a letter");
}

/// The line that an assertion of the parser is about. It reads from left to right: what ends before holds.
toml::source_index lineOfAssertion(std::string_view toml) {
  std::vector<std::size_t> ends;
  for (std::size_t end = toml.find('\n'); end != std::string_view::npos; end = toml.find('\n', end + 1))
    ends.push_back(end);
  const auto holds = [&](std::size_t end) {
    try {
      const toml::table ignored = toml::parse(toml.substr(0, end));
      return true;
    } catch (const std::logic_error&) {
      return false;
    } catch (const toml::parse_error&) {
      return true;
    }
  };
  return static_cast<toml::source_index>(std::ranges::partition_point(ends, holds) - ends.begin()) + 1;
}

toml::table parsed(std::string_view toml, const std::string& file_name) {
  if (toml.starts_with("\xEF\xBB\xBF")) toml.remove_prefix(3);
  std::string_view rest = toml;
  for (Position position{file_name, 1}; !rest.empty(); ++position.line) {
    const std::string_view line = rest.substr(0, rest.find('\n'));
    requireParsable(line, position);
    rest.remove_prefix(std::min(line.size() + 1, rest.size()));
  }
  std::string ascii(toml);
  std::ranges::replace_if(
      ascii, [](unsigned char c) { return c > 127; }, '?');
  try {
    return toml::parse(ascii, file_name);
  } catch (const toml::parse_error& error) {
    constexpr std::size_t kMostCharacters = 200;
    fail({file_name, error.source().begin.line}, "is no TOML: " + printable(error.description(), kMostCharacters));
  } catch (const std::logic_error&) {
    fail({file_name, lineOfAssertion(ascii)}, "is no TOML");
  }
}

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
                const Position& position) {
  if (key == "backend") key = "backend.kind";
  const auto known = std::ranges::find(table, key, &ConfigurationKey::key);
  if (known == table.end())
    fail(position,
         "unknown key '" + printable(key, kMostKeyCharacters) + "'; did you mean '" + nearestKey(table, key) + "'?");
  const Parameter& parameter = known->parameter;
  if (std::visit(Assign{parameter, node}, parameter.value)) return;
  const bool whole = std::holds_alternative<int*>(parameter.value);
  fail(position, "'" + key + "' is " + printable(nodeText(node)) + "; write " + (whole ? "a whole number, " : "") +
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
  applyTable(parameterTable(config), parsed(toml, file_name), "", file_name);
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
      return parsed("value = " + text, name);
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
