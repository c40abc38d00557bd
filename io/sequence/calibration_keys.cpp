#include "io/sequence/calibration_keys.hpp"

#include <algorithm>
#include <array>

#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"
#include "io/rig/yaml_file.hpp"

namespace motorcade {
namespace {

constexpr std::size_t kMaxFile_bytes = std::size_t{1} << 20;

std::string withoutComment(const std::string& text) {
  const std::size_t end = std::min({text.find('#'), text.find("//"), text.size()});
  return trimmed(std::string_view(text).substr(0, end));
}

/// First characters of YAML, JSON and XML files, and the extension that selects their reader.
constexpr std::array<std::array<const char*, 2>, 5> kOtherForms{
    {{"%YAML", ".yaml"}, {"---", ".yaml"}, {"cam0:", ".yaml"}, {"{", ".json"}, {"<", ".xml"}}};

}  // namespace

CalibrationKeys::CalibrationKeys(const std::filesystem::path& file) : file_(file) {
  for (const TextLine& line : readLines(file, LastLine::kKeep, kMaxFile_bytes)) {
    const std::string text = withoutComment(line.text);
    if (text.empty()) continue;
    const std::size_t key_end = std::min(text.find_first_of(":= \t"), text.size());
    const std::size_t rest = std::min(text.find_first_not_of(":= \t", key_end), text.size());
    Line found{.number = line.number, .rest = text.substr(rest)};
    std::ranges::replace_if(
        found.rest, [](char c) { return std::string_view(",;[]()\t").find(c) != std::string_view::npos; }, ' ');
    found.rest = trimmed(found.rest);
    const auto [place, is_new] = lines_.emplace(text.substr(0, key_end), found);
    if (!is_new && place->second.rest != found.rest) place->second.other_number = line.number;
  }
}

void CalibrationKeys::fail(const CalibrationValues& values, const std::string& what) const {
  throw InputError(file_.string() + (values.line > 0 ? ", line " + std::to_string(values.line) : "") + ": key " +
                   printable(values.key) + " " + what);
}

std::vector<double> CalibrationKeys::numbersOf(const std::string& key, const Line& line) const {
  std::vector<double> numbers;
  if (line.rest.empty()) return numbers;
  const TextLine text{line.number, line.rest};
  for (FieldReader fields(file_, text); !fields.atEnd();) numbers.push_back(fields.number(key));
  return numbers;
}

const CalibrationValues* CalibrationKeys::find(const std::vector<std::string>& spellings, std::size_t count) {
  for (const std::string& key : spellings) {
    const auto line = lines_.find(key);
    if (line == lines_.end()) continue;
    const CalibrationValues values{key, line->second.number, numbersOf(key, line->second)};
    if (values.numbers.size() != count)
      fail(values, "has " + std::to_string(values.numbers.size()) + " numbers, " + std::to_string(count) +
                       " are needed" + (values.numbers.size() < count ? ", all in this line" : ""));
    if (line->second.other_number > 0)
      fail(values, "is given once more in line " + std::to_string(line->second.other_number) +
                       ", otherwise; leave the one that is right");
    return &(read_[key] = values);
  }
  return nullptr;
}

std::string CalibrationKeys::valueText(const std::string& key) const {
  const auto line = lines_.find(key);
  return line == lines_.end() ? "" : printable(line->second.rest, 20);
}

std::string CalibrationKeys::projectionsUnderOtherNames() const {
  constexpr std::size_t kProjection = 12, kMostNamed = 4;
  std::vector<std::string> names;
  for (const auto& [key, line] : lines_) {
    try {
      if (numbersOf(key, line).size() == kProjection && key != "Tr_velo_to_cam" && key != "Tr_imu_to_velo")
        names.push_back(printable(key, 20));
    } catch (const InputError&) {
      continue;  // a text, which is nobody's business here
    }
  }
  if (names.size() < 2 || names.size() > kMostNamed) return "";
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  return "it has " + list + ": call the left camera's projection P0 and the right one's P1, in upper case";
}

std::string CalibrationKeys::advice() const {
  const std::string text = readWhole(file_, kMaxFile_bytes);
  throwKnownForm(file_, text);
  for (const auto& [begin, extension] : kOtherForms)
    if (text.starts_with(begin)) return std::string("it seems to be of another form: let its name end in ") + extension;
  if (const std::string other = projectionsUnderOtherNames(); !other.empty()) return other;
  if (has("f") && has("cu") && has("cv") && has("base"))
    return "it has libviso2's values: give --camera " + valueText("f") + "," + valueText("f") + "," + valueText("cu") +
           "," + valueText("cv") + "," + valueText("base");
  for (const char* key : {"K", "K_00", "K_0", "K0", "fx"})
    if (has(key))
      return std::string("its ") + key +
             " tells no baseline: give --camera fx,fy,cx,cy,baseline, or write P0: fx 0 cx 0 0 fy cy 0 0 0 1 0 and "
             "P1: fx 0 cx -fx*baseline 0 fy cy 0 0 0 1 0";
  return "write P0: fx 0 cx 0 0 fy cy 0 0 0 1 0 and P1: fx 0 cx -fx*baseline 0 fy cy 0 0 0 1 0 into it, or give "
         "--camera fx,fy,cx,cy,baseline";
}

}  // namespace motorcade
