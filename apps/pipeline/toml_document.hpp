#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

// toml++ asserts its assumptions without NDEBUG; with it, a wrong one is undefined behavior. Version 3.3 has wrong
// ones, as in times of day.
#pragma push_macro("NDEBUG")
#undef NDEBUG
namespace motorcade {
[[noreturn]] inline void failInParser(const char* what) { throw std::logic_error(what); }
}  // namespace motorcade
#define TOML_ASSERT(holds) (static_cast<bool>(holds) ? void() : motorcade::failInParser(#holds))
#define TOML_HEADER_ONLY 1
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")

/// TOML as people write it. toml++ takes long to compile: include this in few sources.
namespace motorcade {

/// Position of a value, for messages.
struct TomlPosition {
  std::string file;
  toml::source_index line = 0;
  std::string text() const { return line > 0 ? file + ", line " + std::to_string(line) : file; }
};

/// Throws the UsageError that names the position.
[[noreturn]] void failAt(const TomlPosition& position, const std::string& message);

/// Throws UsageError naming file, line and how to fix it. Letters beyond ASCII are in comments only.
toml::table parseToml(std::string_view toml, const std::string& file_name);

}  // namespace motorcade
