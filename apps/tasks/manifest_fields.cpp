#include "apps/tasks/manifest_fields.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <optional>
#include <string_view>
#include <utility>

#include "core/edit_distance.hpp"
#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

constexpr int kMostRepetitions = 100'000, kMostFrames = 1'000'000;
constexpr std::size_t kMostSeeds = 100'000;

constexpr std::array<const char*, 12> kEntryKeys{"path",  "scene", "name",  "length",      "size", "calibration_errors",
                                                 "shake", "sets",  "seeds", "repetitions", "each", "optional"};
/// Names that people give to the column of the drives' paths.
constexpr std::array<const char*, 13> kPathColumns{"path",      "paths",    "drive",   "drives", "sequence",
                                                   "sequences", "folder",   "folders", "dir",    "directory",
                                                   "file",      "filename", "location"};
/// Options of `run`; the last one is one of `evaluate`.
constexpr std::array<const char*, 12> kOptionKeys{"frames",      "fps",   "rate",   "live",   "masks",   "camera",
                                                  "calibration", "bayer", "config", "inject", "require", "baseline"};

template <class Number>
std::optional<Number> numberIn(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

/// Takes the keys of one entry; each failure is a UsageError that names the place and the key.
class EntryReader {
 public:
  explicit EntryReader(const ManifestFields& fields) : fields_(fields) {}

  void requireKnown() const {
    std::vector<std::string> known(kEntryKeys.begin(), kEntryKeys.end());
    known.insert(known.end(), kOptionKeys.begin(), kOptionKeys.end());
    for (const auto& [key, words] : fields_.words) {
      if (std::ranges::find(known, key) != known.end()) continue;
      const std::string nearest = nearestName(key, known);
      fail("unknown key '" + printable(key) + "'" + (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
    }
  }

  std::string word(const char* key) const {
    const auto found = fields_.words.find(key);
    if (found == fields_.words.end() || found->second.empty()) return "";
    if (found->second.size() > 1) fail(std::string("'") + key + "' has several values; write one");
    return found->second.front();
  }

  std::vector<std::string> words(const char* key) const {
    const auto found = fields_.words.find(key);
    return found == fields_.words.end() ? std::vector<std::string>{} : found->second;
  }

  int wholeNumber(const char* key, int fallback, int most) const {
    const std::string text = word(key);
    if (text.empty()) return fallback;
    const auto value = numberIn<int>(text);
    if (!value || *value < 1 || *value > most)
      fail(std::string("'") + key + "' is " + printable(text) + "; write a whole number from 1 to " +
           std::to_string(most));
    return *value;
  }

  /// The number in its shortest form; empty when absent.
  std::string positive(const char* key) const {
    const std::string text = word(key);
    if (text.empty()) return "";
    const auto value = numberIn<double>(text);
    if (!value || !(*value > 0)) fail(std::string("'") + key + "' is " + printable(text) + "; write a number above 0");
    std::array<char, 32> shortest{};
    return {shortest.data(), std::to_chars(shortest.begin(), shortest.end(), *value).ptr};
  }

  [[noreturn]] void fail(const std::string& message) const { throw UsageError(fields_.where + ": " + message); }

 private:
  const ManifestFields& fields_;
};

std::string lowered(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string replaced(std::string text, const std::string& value) {
  constexpr std::string_view kPlace = "{}";
  for (auto at = text.find(kPlace); at != std::string::npos; at = text.find(kPlace, at + value.size()))
    text.replace(at, kPlace.size(), value);
  return text;
}

/// An option that is true or false, or absent.
bool flagOf(const EntryReader& reader, const char* flag) {
  const std::string text = reader.word(flag);
  if (!text.empty() && text != "true" && text != "false")
    reader.fail(std::string("'") + flag + "' is " + printable(text) + "; write true or false");
  return text == "true";
}

void requireConsistent(const ManifestEntry& entry, const EntryReader& reader) {
  if (entry.path.empty() == entry.scene.empty()) reader.fail("needs either 'path', of a drive, or 'scene', to render");
  if (entry.scene.empty() && entry.length > 0) reader.fail("'length' is for scenes; 'frames' = \"A:B\" selects");
  if (entry.scene.empty() && !entry.size.empty()) reader.fail("'size' is for scenes");
  if (entry.scene.empty() && !(entry.calibration_errors.empty() && entry.shake.empty()))
    reader.fail("'calibration_errors' and 'shake' are for scenes: a recorded rig has its own");
  const bool random = !entry.scene.empty() || entry.options.contains("inject");
  if (!entry.seeds.empty() && !random)
    reader.fail(
        "'seeds' are for scenes and injected faults: a run of the same drive gives the same results; for "
        "times, write 'repetitions'");
}

}  // namespace

void requireName(const std::string& name, const std::string& where) {
  constexpr std::size_t kMostCharacters = 100;
  const auto fits = [](unsigned char c) { return std::isalnum(c) != 0 || c == '_' || c == '-'; };
  if (name.empty() || name.size() > kMostCharacters || !std::ranges::all_of(name, fits))
    throw UsageError(where + ": '" + printable(name) + "' is no name; write letters, digits, - and _, at most 100");
}

std::vector<std::uint32_t> seedsIn(const std::vector<std::string>& words, const std::string& where) {
  std::vector<std::uint32_t> all;
  for (const std::string& text : words) {
    const auto dash = text.find('-');
    const auto first = numberIn<std::uint32_t>(std::string_view(text).substr(0, dash));
    const auto last =
        dash == std::string::npos ? first : numberIn<std::uint32_t>(std::string_view(text).substr(dash + 1));
    if (!first || !last || *last < *first || *last - *first >= kMostSeeds - all.size())
      throw UsageError(where + ": 'seeds' has " + printable(text) +
                       "; write whole numbers or ranges of them, as 1-5, at most 100000 in all");
    for (std::uint32_t offset = 0; offset <= *last - *first; ++offset) all.push_back(*first + offset);
  }
  std::ranges::sort(all);
  if (std::ranges::adjacent_find(all) != all.end()) throw UsageError(where + ": 'seeds' has a number twice");
  return all;
}

namespace {

ManifestEntry entryOf(const ManifestFields& fields) {
  const EntryReader reader(fields);
  reader.requireKnown();
  auto paths = reader.words("path");
  const std::string path = paths.empty() ? "" : paths.front();
  if (!paths.empty()) paths.erase(paths.begin());
  ManifestEntry entry{.path = path,
                      .other_paths = std::move(paths),
                      .optional = flagOf(reader, "optional"),
                      .scene = reader.word("scene"),
                      .name = reader.word("name"),
                      .length = reader.wholeNumber("length", 0, kMostFrames),
                      .size = reader.word("size"),
                      .calibration_errors = reader.positive("calibration_errors"),
                      .shake = reader.positive("shake"),
                      .sets = reader.words("sets"),
                      .seeds = seedsIn(reader.words("seeds"), fields.where),
                      .repetitions = reader.wholeNumber("repetitions", 1, kMostRepetitions),
                      .where = fields.where};
  for (const char* const key : kOptionKeys)
    if (const std::string value = reader.word(key); !value.empty()) entry.options[key] = value;
  for (const char* const flag : {"live", "masks"}) flagOf(reader, flag);
  requireConsistent(entry, reader);
  if (!entry.name.empty()) requireName(entry.name, fields.where);
  return entry;
}

}  // namespace

std::vector<ManifestEntry> manifestEntries(const ManifestFields& fields) {
  const auto each = fields.words.find("each");
  if (each == fields.words.end()) return {entryOf(fields)};
  std::vector<ManifestEntry> entries;
  for (const std::string& value : each->second) {
    ManifestFields one = fields;
    one.words.erase("each");
    for (auto& [key, words] : one.words)
      for (std::string& word : words) word = replaced(word, value);
    entries.push_back(entryOf(one));
  }
  return entries;
}

std::string columnKey(const std::string& head) {
  const std::string key = lowered(head);
  if (std::ranges::find(kPathColumns, key) != kPathColumns.end()) return "path";
  if (key == "set" || key.find('.') != std::string::npos) return key == "set" ? key : head;
  const bool known = std::ranges::find(kEntryKeys, key) != kEntryKeys.end() ||
                     std::ranges::find(kOptionKeys, key) != kOptionKeys.end();
  return known ? key : "";
}

}  // namespace motorcade
