#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace motorcade {

/// A key of a calibration in text, and its numbers.
struct CalibrationValues {
  std::string key;
  int line = 0;
  std::vector<double> numbers{};
};

/// Lines `KEY: NUMBERS` of a text. Comments (# or //), commas and brackets are skipped, and values of other keys are
/// not read. Throws InputError that names file, line and key.
class CalibrationKeys {
 public:
  explicit CalibrationKeys(const std::filesystem::path& file);

  /// The first of several spellings that the file has; it must have `count` values. Null where the file has none of
  /// them.
  const CalibrationValues* find(const std::vector<std::string>& spellings, std::size_t count);
  bool has(const std::string& key) const { return lines_.contains(key); }
  /// Advice for a file without projections: a guess at its form, and how to mend it. Empty for an unknown content.
  std::string advice() const;

  const std::filesystem::path& file() const { return file_; }
  [[noreturn]] void fail(const CalibrationValues& values, const std::string& what) const;

 private:
  struct Line {
    int number;
    std::string rest;
    int other_number = 0;  // of a later line with this key and another content
  };

  std::vector<double> numbersOf(const std::string& key, const Line& line) const;
  /// Nothing where it is no number.
  std::string valueText(const std::string& key) const;
  std::string projectionsUnderOtherNames() const;

  std::filesystem::path file_;
  std::map<std::string, Line> lines_;
  std::map<std::string, CalibrationValues> read_;
};

}  // namespace motorcade
