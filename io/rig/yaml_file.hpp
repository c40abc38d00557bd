#pragma once

#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/rig/yaml_module.hpp"

namespace motorcade {

/// The parts of an XML text as OpenCV writes it: a leaf of several words is a list, and so are elements named `_`.
/// The root element's own name counts for nothing.
YamlAnswer parsedXml(const std::string& text);

/// Throws InputError for a calibration of a form that is known but not read. The message has the name of the form and
/// what to give in its place.
void throwKnownForm(const std::filesystem::path& file, std::string_view text);

struct YamlNode;

/// A part of a file in YAML, JSON or OpenCV's XML, with its name for messages. A fault in it is an InputError that
/// names file, key and line.
class YamlPart {
 public:
  /// Reads a file of at most a megabyte. OpenCV's first line, `%YAML:1.0`, is accepted although it is not YAML.
  static YamlPart ofFile(const std::filesystem::path& file);

  /// The first of several spellings of a key that is there. `A.B` is a key of that name, or B within A.
  std::optional<YamlPart> find(std::initializer_list<std::string_view> keys) const;
  /// The same, where one of them must be there.
  YamlPart at(std::initializer_list<std::string_view> keys) const;

  /// All numbers in the order of the file: of a list, of a list of lists, or of the `data` of a matrix.
  std::vector<double> numbers() const;
  std::vector<double> numbers(std::size_t count) const;
  double number() const { return numbers(1).front(); }
  std::string text() const;
  /// The parts of a list; none of anything else.
  std::vector<YamlPart> items() const;

  const std::filesystem::path& file() const { return file_; }
  [[noreturn]] void fail(const std::string& what) const;

 private:
  YamlPart(std::filesystem::path file, std::string key, std::shared_ptr<const YamlNode> node);

  std::filesystem::path file_;
  std::string key_;
  std::shared_ptr<const YamlNode> node_;
};

}  // namespace motorcade
