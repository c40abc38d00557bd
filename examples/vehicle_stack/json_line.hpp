#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace vehicle_stack {

/// One JSON object on one line, written field by field. What is no number is null.
class JsonLine {
 public:
  explicit JsonLine(std::string_view type) { add("type", type); }

  JsonLine& add(std::string_view key, std::string_view value);
  JsonLine& add(std::string_view key, const char* value) { return add(key, std::string_view(value)); }
  JsonLine& add(std::string_view key, std::int64_t value);
  JsonLine& add(std::string_view key, double value);
  JsonLine& add(std::string_view key, bool value);
  JsonLine& add(std::string_view key, const std::vector<std::int64_t>& values);
  JsonLine& addNull(std::string_view key);
  template <std::size_t kSize>
  JsonLine& add(std::string_view key, const std::array<double, kSize>& values) {
    return addNumbers(key, values.data(), kSize);
  }

  /// Closed, with its line end.
  std::string text() const { return text_ + "}\n"; }

 private:
  void begin(std::string_view key);
  void append(double value);
  JsonLine& addNumbers(std::string_view key, const double* values, std::size_t count);

  std::string text_ = "{";
};

}  // namespace vehicle_stack
