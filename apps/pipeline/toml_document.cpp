#include "apps/pipeline/toml_document.hpp"

#include <algorithm>
#include <cctype>
#include <vector>

#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

/// Upper bound of the names in a key on this line: its dots, where several in a row count once.
int namesOn(std::string_view line) {
  int names = 0;
  char before = '.';
  for (const char c : line) {
    if (c == '.' && before != '.') ++names;
    if (c != ' ' && c != '\t') before = c;
  }
  return names;
}

/// Refuses input that toml++ cannot handle. Letters beyond ASCII in a key are undefined behavior in 3.3. Tables nested
/// by the thousand overflow the stack. Headers must not begin with a character that begins no name.
void requireParsable(std::string_view line, const TomlPosition& position) {
  constexpr int kMostNames = 100;  // our keys have three
  const auto begins_name = [](unsigned char c) {
    return std::isalnum(c) != 0 || std::string_view("_-\"']").find(static_cast<char>(c)) != std::string_view::npos;
  };
  if (std::ranges::any_of(line.substr(0, line.find('#')), [](unsigned char c) { return c > 127; }))
    failAt(position, "has a letter that is not ASCII; only comments may");
  if (namesOn(line) > kMostNames) failAt(position, "has more than 100 dots; no key has as many");
  line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
  if (!line.starts_with('[')) return;
  line.remove_prefix(std::min(line.find_first_not_of("[ \t"), line.size()));
  if (line.empty() || !begins_name(line.front())) failAt(position, "a section's name must begin with a letter");
}

/// The line on which an assertion of the parser fails. The parser reads from left to right, so that any shorter prefix
/// holds.
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

}  // namespace

void failAt(const TomlPosition& position, const std::string& message) {
  throw UsageError(position.text() + ": " + message);
}

toml::table parseToml(std::string_view toml, const std::string& file_name) {
  if (toml.starts_with("\xEF\xBB\xBF")) toml.remove_prefix(3);
  std::string_view rest = toml;
  for (TomlPosition position{file_name, 1}; !rest.empty(); ++position.line) {
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
    failAt({file_name, error.source().begin.line}, "is no TOML: " + printable(error.description(), kMostCharacters));
  } catch (const std::logic_error&) {
    failAt({file_name, lineOfAssertion(ascii)}, "is no TOML");
  }
}

}  // namespace motorcade
