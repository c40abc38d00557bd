#pragma once

#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace motorcade {

/// Appends `value` with `decimals` digits after the point: the same bytes on every machine and in every locale.
inline void appendFixed(std::string& text, double value, int decimals) {
  char buffer[400];
  const auto end = std::to_chars(buffer, buffer + sizeof(buffer), value + 0.0, std::chars_format::fixed, decimals).ptr;
  text.append(buffer, end);
}

/// The same in scientific form, as KITTI prints its poses.
inline void appendScientific(std::string& text, double value, int decimals) {
  char buffer[64];
  const auto end =
      std::to_chars(buffer, buffer + sizeof(buffer), value + 0.0, std::chars_format::scientific, decimals).ptr;
  text.append(buffer, end);
}

/// The finite number that the whole text spells; empty for any other text.
inline std::optional<double> numberIn(std::string_view text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [read, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || read != end || !std::isfinite(value)) return std::nullopt;
  return value;
}

inline void appendInteger(std::string& text, std::int64_t value) { text += std::to_string(value); }

}  // namespace motorcade
