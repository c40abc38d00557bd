#include "apps/tasks/path_text.hpp"

#include <cctype>
#include <cstdlib>
#include <optional>
#include <string_view>

namespace motorcade {
namespace {

/// A variable's position in a text, with the dollar and the braces.
struct NamedVariable {
  std::size_t begin = 0, length = 0;
  std::string name{};
};

std::optional<NamedVariable> nextVariable(std::string_view text, std::size_t from) {
  const auto ofName = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  for (std::size_t at = text.find('$', from); at != std::string_view::npos; at = text.find('$', at + 1)) {
    const bool braces = at + 1 < text.size() && text[at + 1] == '{';
    const std::size_t begin = at + (braces ? 2 : 1);
    std::size_t end = begin;
    while (end < text.size() && ofName(text[end])) ++end;
    const bool closed = !braces || (end < text.size() && text[end] == '}');
    if (end == begin || !closed) continue;
    return NamedVariable{at, end - at + (braces ? 1 : 0), std::string(text.substr(begin, end - begin))};
  }
  return std::nullopt;
}

}  // namespace

std::string expandedPath(const std::string& text) {
  std::string path = text;
  const char* const home = std::getenv("HOME");
  if (home != nullptr && (path == "~" || path.starts_with("~/"))) path.replace(0, 1, home);
  for (auto variable = nextVariable(path, 0); variable;) {
    const char* const value = std::getenv(variable->name.c_str());
    const std::size_t kept = value == nullptr ? variable->length : std::string_view(value).size();
    if (value != nullptr) path.replace(variable->begin, variable->length, value);
    variable = nextVariable(path, variable->begin + kept);
  }
  return path;
}

std::string unsetVariable(const std::string& expanded) {
  const auto variable = nextVariable(expanded, 0);
  return variable ? "$" + variable->name : "";
}

}  // namespace motorcade
