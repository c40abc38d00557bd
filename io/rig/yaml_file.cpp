#include "io/rig/yaml_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <locale>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>

#include "core/module.hpp"
#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"
#include "io/rig/yaml_module.hpp"

namespace motorcade {
namespace {

/// A text that differs from what OpenCV writes.
struct NoXml {
  int line;
  const char* problem;
};

/// Takes elements from a text, the outer one first. Each part consumes some of the text, so that it comes to an end.
class XmlReader {
 public:
  explicit XmlReader(std::string_view text) : rest_(text) {}

  YamlNode root() {
    skipRemarks();
    return element(0);
  }

 private:
  using Kind = YamlNode::Kind;

  [[noreturn]] void fail(const char* problem) const { throw NoXml{line_, problem}; }
  /// Returns the text before `end` and skips both.
  std::string_view upTo(std::string_view end) {
    const std::size_t found = rest_.find(end);
    if (found == std::string_view::npos) fail("an element does not end");
    const std::string_view before = rest_.substr(0, found);
    line_ += static_cast<int>(std::ranges::count(before, '\n'));
    rest_.remove_prefix(found + end.size());
    return before;
  }
  /// Skips blanks, `<?...?>` and `<!--...-->`.
  void skipRemarks() {
    while (true) {
      const std::size_t begin = std::min(rest_.find_first_not_of(" \t\r\n\xef\xbb\xbf"), rest_.size());
      line_ += static_cast<int>(std::ranges::count(rest_.substr(0, begin), '\n'));
      rest_.remove_prefix(begin);
      if (rest_.starts_with("<?"))
        upTo("?>");
      else if (rest_.starts_with("<!--"))
        upTo("-->");
      else
        return;
    }
  }
  YamlNode element(int depth);

  std::string_view rest_;
  int line_ = 1;
};

void setLeaf(YamlNode& node, std::string_view content) {
  std::istringstream words{std::string(content)};
  for (std::string word; words >> word;)
    node.parts.push_back({.kind = YamlNode::Kind::kScalar, .line = node.line, .text = std::move(word)});
  node.kind = node.parts.empty() ? YamlNode::Kind::kEmpty : YamlNode::Kind::kSequence;
  if (node.parts.size() != 1) return;
  node.kind = YamlNode::Kind::kScalar;
  node.text = std::exchange(node.parts, {}).front().text;
}

YamlNode XmlReader::element(int depth) {
  constexpr int kDeepest = 64;
  if (depth == kDeepest) fail("it nests too deep");
  if (!rest_.starts_with('<')) fail("an element is expected");
  YamlNode node{.kind = Kind::kMap, .line = line_};
  const std::string_view tag = upTo(">").substr(1);
  node.key = tag.substr(0, tag.find_first_of(" \t\r\n/"));
  if (tag.ends_with('/')) return node;
  const std::string end = "</" + node.key + ">";
  const std::size_t next = rest_.find('<');
  if (next != std::string_view::npos && rest_.substr(next).starts_with(end)) {
    setLeaf(node, upTo(end));
    return node;
  }
  for (skipRemarks(); !rest_.starts_with(end); skipRemarks()) node.parts.push_back(element(depth + 1));
  upTo(end);
  const auto is_item = [](const YamlNode& part) { return part.key == "_"; };
  if (std::ranges::all_of(node.parts, is_item)) node.kind = Kind::kSequence;
  return node;
}

}  // namespace

YamlAnswer parsedXml(const std::string& text) {
  YamlAnswer answer;
  try {
    answer.root = XmlReader(text).root();
  } catch (const NoXml& found) {
    answer = {.outcome = YamlAnswer::Outcome::kNoYaml, .line = found.line, .problem = found.problem};
  }
  return answer;
}

namespace {

/// A form that is recognized by its beginning and by texts that it all contains.
struct KnownForm {
  const char* name;
  std::string_view begin;
  std::array<std::string_view, 3> parts;
  const char* advice;
};

constexpr const char* kByPython =
    "write its matrices with OpenCV's cv2.FileStorage('stereo.yml', cv2.FileStorage_WRITE) as M1 D1 M2 D2 R T, and "
    "give stereo.yml";
constexpr const char* kByMatlab =
    "write its values into stereo.yml as M1 D1 M2 D2 R T: IntrinsicMatrix and RotationOfCamera2 transposed, "
    "distortion as k1 k2 p1 p2 k3, TranslationOfCamera2 in meters";
constexpr const char* kByHand = "write its values into stereo.yml as M1 D1 M2 D2 R T, T in meters, and give that";
constexpr const char* kRectified = "give --camera fx,fy,cx,cy,baseline of the rectified images (pixels; meters)";

const std::array kForms{
    KnownForm{"an archive, as NumPy's .npz", "PK\x03\x04", {}, kByPython},
    KnownForm{"an array of NumPy", "\x93NUMPY", {}, kByPython},
    KnownForm{"a pickle of Python", "\x80", {}, kByPython},
    KnownForm{"a file of MATLAB", "MATLAB", {}, kByMatlab},
    KnownForm{"an HDF5 file, as MATLAB's", "\x89HDF", {}, kByMatlab},
    KnownForm{"a script of the Caltech toolbox", "", {"fc_left", "fc_right", "om"}, kByMatlab},
    KnownForm{"Kalibr's report", "", {"Camera-system parameters"}, "give camchain-*.yaml, which Kalibr wrote with it"},
    KnownForm{"a ZED's own calibration, by which its SDK rectifies", "", {"[LEFT_CAM_", "[STEREO]"}, kRectified},
    KnownForm{"a calibration of MRPT", "", {"[CAMERA_PARAMS_LEFT"}, kByHand},
    KnownForm{"ROS' older form (ost.txt, *.ini)",
              "",
              {"camera matrix", "rectification", "projection"},
              "give left.yaml,right.yaml, which lie beside it"},
    KnownForm{"a report of a RealSense, whose infrared images are rectified", "", {"Intrinsic of", "PPX"}, kRectified},
    KnownForm{"DepthAI's (OAK's) own calibration, by which the device rectifies",
              "",
              {"cameraData", "intrinsicMatrix"},
              kRectified},
    KnownForm{"COLMAP's list of cameras", "", {"Camera list with one line of data per camera"}, kByHand},
    KnownForm{"nuScenes' table of cameras, which has no stereo pair",
              "",
              {"camera_intrinsic", "sensor_token"},
              "give the calibration of a pair"},
    KnownForm{"a rig of Isaac (edex)", "", {"distortion_params", "principal", "transform"}, kByHand},
    KnownForm{"OpenVINS' configuration",
              "",
              {"relative_config_imucam"},
              "give the chain that it names, kalibr_imucam_chain.yaml"},
    KnownForm{"DSO's calibration of one camera", "Pinhole ", {}, kRectified},
    KnownForm{"DSO's calibration of one camera", "RadTan ", {}, kRectified},
    KnownForm{"DSO's calibration of one camera", "EquiDistant ", {}, kRectified},
    KnownForm{"DSO's calibration of one camera", "KannalaBrandt ", {}, kRectified}};

bool isOf(const KnownForm& form, std::string_view text) {
  const auto has = [&](std::string_view part) { return text.find(part) != std::string_view::npos; };
  return text.starts_with(form.begin) && std::ranges::all_of(form.parts, has);
}

}  // namespace

void throwKnownForm(const std::filesystem::path& file, std::string_view text) {
  const auto found = std::ranges::find_if(kForms, [&](const KnownForm& form) { return isOf(form, text); });
  if (found == kForms.end()) return;
  throw InputError(file.string() + ": is no calibration that is read: it is " + found->name + "; " + found->advice);
}

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
