#include "io/rig/yaml_file.hpp"

#include <algorithm>
#include <cmath>
#include <locale>
#include <sstream>
#include <utility>

#include "core/module.hpp"
#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"
#include "io/rig/known_forms.hpp"
#include "io/rig/xml_file.hpp"
#include "io/rig/yaml_module.hpp"

namespace motorcade {

extern "C" [[gnu::weak, gnu::visibility("hidden")]] decltype(motorcade_yaml_1) motorcade_yaml_1;

namespace {

using Kind = YamlNode::Kind;

constexpr std::size_t kMostBytes = std::size_t{1} << 20, kMostNumbers = 256;

std::string lineText(int line) { return line == 0 ? "" : ", line " + std::to_string(line); }

bool isXml(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  return first != std::string::npos && text[first] == '<';
}

/// YAML is parsed by the module, which is loaded where it is not linked in.
YamlAnswer parsed(const std::filesystem::path& file, const std::string& text) {
  if (isXml(text)) return parsedXml(text);
  YamlAnswer answer;
  try {
    linkedOrLoaded(&motorcade_yaml_1, kYamlModule, kYamlFunction)(text, answer);
  } catch (const ModuleError& error) {
    throw InputError(file.string() + ": is YAML, which is read by a module: " + error.what());
  }
  return answer;
}

/// The first part of that name; null where there is none.
const YamlNode* partNamed(const YamlNode& node, std::string_view key) {
  if (node.kind != Kind::kMap) return nullptr;
  if (const auto found = std::ranges::find(node.parts, key, &YamlNode::key); found != node.parts.end()) return &*found;
  const std::size_t dot = key.find('.');
  if (dot == std::string_view::npos) return nullptr;
  const YamlNode* outer = partNamed(node, key.substr(0, dot));
  return outer == nullptr ? nullptr : partNamed(*outer, key.substr(dot + 1));
}

std::optional<double> numberOf(const std::string& text) {
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  double value = 0;
  if (!(stream >> std::noskipws >> value) || !(stream >> std::ws).eof()) return std::nullopt;
  if (!std::isfinite(value) || std::abs(value) > kLargestNumber) return std::nullopt;
  return value;
}

/// Appends the numbers of a list, however deep. False where there are too many, or where it holds anything else.
bool collect(const YamlNode& node, std::vector<double>& numbers, int depth = 0) {
  constexpr int kDeepest = 4;
  if (const YamlNode* data = partNamed(node, "data"); data != nullptr && depth == 0)
    return collect(*data, numbers, depth + 1);
  if (node.kind == Kind::kScalar) {
    const auto value = numberOf(node.text);
    if (value) numbers.push_back(*value);
    return value && numbers.size() <= kMostNumbers;
  }
  if (node.kind != Kind::kSequence || depth == kDeepest) return false;
  return std::ranges::all_of(node.parts, [&](const YamlNode& item) { return collect(item, numbers, depth + 1); });
}

}  // namespace

YamlPart::YamlPart(std::filesystem::path file, std::string key, std::shared_ptr<const YamlNode> node)
    : file_(std::move(file)), key_(std::move(key)), node_(std::move(node)) {}

YamlPart YamlPart::ofFile(const std::filesystem::path& file) {
  std::string text = readWhole(file, kMostBytes);
  if (text.starts_with("%YAML")) std::fill_n(text.begin(), std::min(text.find_first_of("\r\n"), text.size()), ' ');
  YamlAnswer answer = parsed(file, text);
  if (answer.outcome != YamlAnswer::Outcome::kRead || answer.root.kind != Kind::kMap) throwKnownForm(file, text);
  if (answer.outcome != YamlAnswer::Outcome::kRead)
    throw InputError(file.string() + lineText(answer.line) + ": is no " +
                     (answer.outcome != YamlAnswer::Outcome::kNoYaml ? "calibration: "
                      : isXml(text)                                  ? "XML: "
                                                                     : "YAML: ") +
                     printable(answer.problem, 80));
  if (answer.root.kind != Kind::kMap)
    throw InputError(file.string() + ": holds no keys; a calibration in YAML, JSON or OpenCV's XML is expected");
  return {file, "", std::make_shared<const YamlNode>(std::move(answer.root))};
}

std::optional<YamlPart> YamlPart::find(std::initializer_list<std::string_view> keys) const {
  for (const std::string_view key : keys)
    if (const YamlNode* found = partNamed(*node_, key))
      return YamlPart(file_, (key_.empty() ? "" : key_ + ".") + std::string(key), {node_, found});
  return std::nullopt;
}

std::vector<YamlPart> YamlPart::items() const {
  std::vector<YamlPart> items;
  if (node_->kind != Kind::kSequence) return items;
  for (const YamlNode& item : node_->parts)
    items.push_back(YamlPart(file_, key_ + "[" + std::to_string(items.size()) + "]", {node_, &item}));
  return items;
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
  if (node_->kind != Kind::kScalar) fail("holds no word");
  return node_->text;
}

void YamlPart::fail(const std::string& what) const {
  throw InputError(file_.string() + lineText(node_->line) + ": key " + printable(key_) + " " + what);
}

}  // namespace motorcade
