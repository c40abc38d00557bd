#include "json_line.hpp"

#include <cmath>
#include <cstdio>

namespace vehicle_stack {
namespace {

std::string quoted(std::string_view value) {
  std::string text = "\"";
  for (const char c : value) {
    char escaped[8];
    if (static_cast<unsigned char>(c) < 0x20) {
      std::snprintf(escaped, sizeof escaped, "\\u%04x", static_cast<unsigned>(c));
      text += escaped;
    } else {
      if (c == '"' || c == '\\') text += '\\';
      text += c;
    }
  }
  return text + '"';
}

}  // namespace

void JsonLine::begin(std::string_view key) {
  if (text_.size() > 1) text_ += ',';
  text_ += quoted(key);
  text_ += ':';
}

void JsonLine::append(double value) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.6g", value);
  text_ += std::isfinite(value) ? digits : "null";
}

JsonLine& JsonLine::add(std::string_view key, std::string_view value) {
  begin(key);
  text_ += quoted(value);
  return *this;
}

JsonLine& JsonLine::add(std::string_view key, std::int64_t value) {
  begin(key);
  text_ += std::to_string(value);
  return *this;
}

JsonLine& JsonLine::add(std::string_view key, double value) {
  begin(key);
  append(value);
  return *this;
}

JsonLine& JsonLine::add(std::string_view key, bool value) {
  begin(key);
  text_ += value ? "true" : "false";
  return *this;
}

JsonLine& JsonLine::add(std::string_view key, const std::vector<std::int64_t>& values) {
  begin(key);
  text_ += '[';
  for (const std::int64_t value : values) {
    if (text_.back() != '[') text_ += ',';
    text_ += std::to_string(value);
  }
  text_ += ']';
  return *this;
}

JsonLine& JsonLine::addNull(std::string_view key) {
  begin(key);
  text_ += "null";
  return *this;
}

JsonLine& JsonLine::addNumbers(std::string_view key, const double* values, std::size_t count) {
  begin(key);
  for (std::size_t i = 0; i < count; ++i) {
    text_ += i == 0 ? '[' : ',';
    append(values[i]);
  }
  text_ += ']';
  return *this;
}

}  // namespace vehicle_stack
