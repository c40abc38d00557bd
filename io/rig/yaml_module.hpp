#pragma once

#include <string>
#include <string_view>
#include <vector>

/// The interface of the module `yaml.so` (core/module.hpp): yaml-cpp's parser. The number in the function's name is
/// raised with each change in this file, so that a module of another version is refused.
namespace motorcade {

struct YamlNode {
  enum class Kind { kEmpty, kScalar, kSequence, kMap };
  Kind kind = Kind::kEmpty;
  int line = 0;                   // counted from one
  std::string key{};              // of a map's part
  std::string text{};             // of a scalar
  std::vector<YamlNode> parts{};  // of a map in the order of the file, but for those whose key is no scalar
};

struct YamlAnswer {
  enum class Outcome { kRead, kNoYaml, kNoCalibration };  // of the last, what no calibration has, as depth
  Outcome outcome = Outcome::kRead;
  YamlNode root{};
  int line = 0;  // of the problem, where it has one
  std::string problem{};
};

inline constexpr char kYamlModule[] = "yaml", kYamlFunction[] = "motorcade_yaml_1";

/// Parses a text's first document. Aliases are replaced by copies, within a bound for all copies and parts.
extern "C" void motorcade_yaml_1(std::string_view text, YamlAnswer& answer) noexcept;

}  // namespace motorcade
