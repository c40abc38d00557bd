#include "io/rig/yaml_file.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <yaml-cpp/yaml.h>

#include "io/errors.hpp"
#include "io/text_file.hpp"

namespace motorcade {
namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 20, kMostNumbers = 256;

std::string lineOf(const YAML::Mark& mark) { return mark.is_null() ? "" : ", line " + std::to_string(mark.line + 1); }

/// Appends the numbers of a list, however deep. False where there are too many, or something else.
bool collect(const YAML::Node& node, std::vector<double>& numbers, int depth = 0) {
  constexpr int kDeepest = 4;
  if (node.IsMap() && depth == 0 && node["data"]) return collect(node["data"], numbers, depth + 1);
  if (node.IsScalar()) {
    double value = 0;
    if (!YAML::convert<double>::decode(node, value) || !std::isfinite(value) || std::abs(value) > kLargestNumber)
      return false;
    numbers.push_back(value);
    return numbers.size() <= kMostNumbers;
  }
  if (!node.IsSequence() || depth == kDeepest) return false;
  return std::ranges::all_of(node, [&](const YAML::Node& item) { return collect(item, numbers, depth + 1); });
}

}  // namespace

YamlPart::YamlPart(std::filesystem::path file, std::string key, const YAML::Node& node)
    : file_(std::move(file)), key_(std::move(key)), node_(std::make_shared<const YAML::Node>(node)) {}

YamlPart YamlPart::ofFile(const std::filesystem::path& file) {
  std::string text = readWhole(file, kMostBytes);
  if (text.starts_with("%YAML")) std::fill_n(text.begin(), std::min(text.find_first_of("\r\n"), text.size()), ' ');
  try {
    const YAML::Node root = YAML::Load(text);
    if (!root.IsMap()) throw InputError(file.string() + ": holds no keys; a calibration in YAML is expected");
    return {file, "", root};
  } catch (const YAML::Exception& error) {
    throw InputError(file.string() + lineOf(error.mark) + ": is no YAML: " + printable(error.msg, 80));
  }
}

std::optional<YamlPart> YamlPart::find(std::initializer_list<std::string_view> keys) const {
  if (!node_->IsMap()) return std::nullopt;
  for (const std::string_view key : keys) {
    const YAML::Node found = (*node_)[std::string(key)];
    if (found) return YamlPart(file_, (key_.empty() ? "" : key_ + ".") + std::string(key), found);
  }
  return std::nullopt;
}

YamlPart YamlPart::at(std::initializer_list<std::string_view> keys) const {
  if (auto part = find(keys)) return *std::move(part);
  throw InputError(file_.string() + ": key " + (key_.empty() ? "" : key_ + ".") + std::string(*keys.begin()) +
                   " is missing");
}

std::vector<double> YamlPart::numbers() const {
  std::vector<double> numbers;
  if (!collect(*node_, numbers)) fail("holds no list of numbers");
  return numbers;
}

std::vector<double> YamlPart::numbers(std::size_t count) const {
  std::vector<double> all = numbers();
  if (all.size() != count)
    fail("has " + std::to_string(all.size()) + " numbers, " + std::to_string(count) + " are needed");
  return all;
}

std::string YamlPart::text() const {
  if (!node_->IsScalar()) fail("holds no word");
  return node_->Scalar();
}

void YamlPart::fail(const std::string& what) const {
  throw InputError(file_.string() + lineOf(node_->Mark()) + ": key " + printable(key_) + " " + what);
}

}  // namespace motorcade
