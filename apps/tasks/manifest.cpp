#include "apps/tasks/manifest.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <optional>
#include <string_view>
#include <utility>

#include "core/edit_distance.hpp"
#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

constexpr std::size_t kMostBytes = std::size_t{1} << 26;

std::string contentOf(const std::filesystem::path& file) {
  try {
    return readWhole(file, kMostBytes);
  } catch (const InputError& error) {
    throw UsageError(error.what());
  }
}

bool hasSet(const Manifest& manifest, const std::string& name) {
  return std::ranges::find(manifest.sets, name, &ParameterSet::name) != manifest.sets.end();
}

void requireKnownSets(const Manifest& manifest) {
  for (const ManifestEntry& entry : manifest.entries)
    for (const std::string& set : entry.sets)
      if (!hasSet(manifest, set)) throw UsageError(entry.where + ": there is no [sets." + printable(set) + "]");
  if (!manifest.baseline_set.empty() && !hasSet(manifest, manifest.baseline_set))
    throw UsageError(manifest.file.string() + ": baseline_set: there is no [sets." + printable(manifest.baseline_set) +
                     "]");
}

bool isTable(const std::filesystem::path& file) {
  const std::string end = file.extension().string();
  return end == ".csv" || end == ".tsv" || end == ".txt" || end == ".lst" || end == ".list";
}

/// A variable's position in a text, with the dollar and the braces.
struct NamedVariable {
  std::size_t begin = 0, length = 0;
  std::string name{};
};

std::optional<NamedVariable> nextVariable(std::string_view text, std::size_t from) {
  const auto ofName = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  for (std::size_t at = text.find('$', from); at != std::string_view::npos; at = text.find('$', at + 1)) {
    const bool braces = at + 1 < text.size() && text[at + 1] == '{';
    const std::size_t begin = at + (braces ? 2 : 1);
    std::size_t end = begin;
    while (end < text.size() && ofName(text[end])) ++end;
    const bool closed = !braces || (end < text.size() && text[end] == '}');
    if (end == begin || !closed) continue;
    return NamedVariable{at, end - at + (braces ? 1 : 0), std::string(text.substr(begin, end - begin))};
  }
  return std::nullopt;
}

/// The first variable that was left in an expanded path, as $NAME; empty where there is none.
std::string unsetVariable(const std::string& expanded) {
  const auto variable = nextVariable(expanded, 0);
  return variable ? "$" + variable->name : "";
}

/// The manifest's own root, relative to the manifest's folder. It may name a variable of the environment.
std::filesystem::path ownRoot(const Manifest& manifest) {
  const std::string root = expandedPath(manifest.root.string());
  if (const std::string missing = unsetVariable(root); !missing.empty())
    throw UsageError(manifest.file.string() + ": its root is " + missing +
                     ", which is not set; give --root FOLDER, or " + "export " + missing.substr(1) +
                     "=FOLDER, the folder that holds " + printable(manifest.entries.front().path, 80));
  return manifest.file.parent_path() / root;
}

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

Manifest readManifest(const std::filesystem::path& file, const std::filesystem::path& root) {
  const auto absolute = std::filesystem::absolute(file).lexically_normal();
  const std::string text = contentOf(absolute);
  const bool table = isTable(file);
  Manifest manifest = table ? readManifestCsv(absolute, text) : readManifestToml(absolute, text);
  if (manifest.entries.empty())
    throw UsageError(file.string() + ": has no drives; write " +
                     (table ? "a line with the path of each" : "[[drives]] with a path or a scene for each"));
  if (manifest.sets.empty()) manifest.sets.push_back({.name = "default"});
  requireKnownSets(manifest);
  manifest.root = root.empty() ? ownRoot(manifest) : std::filesystem::absolute(root);
  manifest.root = manifest.root.lexically_normal();
  return manifest;
}

std::string expandedPath(const std::string& text) {
  std::string path = text;
  const char* const home = std::getenv("HOME");
  if (home != nullptr && (path == "~" || path.starts_with("~/"))) path.replace(0, 1, home);
  for (auto variable = nextVariable(path, 0); variable;) {
    const char* const value = std::getenv(variable->name.c_str());
    const std::size_t kept = value == nullptr ? variable->length : std::string_view(value).size();
    if (value != nullptr) path.replace(variable->begin, variable->length, value);
    variable = nextVariable(path, variable->begin + kept);
  }
  return path;
}

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
