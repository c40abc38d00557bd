#pragma once

#include <charconv>
#include <cstdint>
#include <string>

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

inline void appendInteger(std::string& text, std::int64_t value) { text += std::to_string(value); }

}  // namespace motorcade
