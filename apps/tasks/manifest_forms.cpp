#include <algorithm>
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "apps/pipeline/toml_document.hpp"
#include "apps/tasks/manifest.hpp"
#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

/// Characters that separate fields, as programs for tables in many countries write them.
constexpr std::string_view kSeparators = ",;\t";

/// A line of a table, and its position for messages.
struct TableLine {
  std::string text{};
  std::string where{};
};

/// Splits a line into fields. A field with a separator stands between quotes, in which two quotes are one (RFC 4180).
/// Single quotes around a field are removed, too.
std::vector<std::string> fieldsOf(const TableLine& line, char separator) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.text.size(); ++i) {
    const char c = line.text[i];
    if (c == '"' && quoted && i + 1 < line.text.size() && line.text[i + 1] == '"')
      fields.back() += line.text[++i];
    else if (c == '"')
      quoted = !quoted;
    else if (c == separator && !quoted)
      fields.emplace_back();
    else
      fields.back() += c;
  }
  if (quoted) throw UsageError(line.where + ": a quote is not closed");
  for (std::string& field : fields) {
    field = trimmed(field);
    if (field.size() >= 2 && field.front() == '\'' && field.back() == '\'') field = field.substr(1, field.size() - 2);
  }
  return fields;
}

/// Cuts off a comment, which begins the line or follows a blank, outside of quotes.
std::string withoutComment(const std::string& line) {
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (line[i] == '"') quoted = !quoted;
    const bool begins = i == 0 || line[i - 1] == ' ' || line[i - 1] == '\t';
    if (line[i] == '#' && !quoted && begins) return line.substr(0, i);
  }
  return line;
}

/// The lines that are neither blank nor comments. Accepts all line ends and a byte order mark.
std::vector<TableLine> linesOf(const std::filesystem::path& file, std::string text) {
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF") || text.find('\0') != std::string::npos)
    throw UsageError(file.string() +
                     ": is not UTF-8, perhaps \"Unicode text\" of a program for tables; save it as CSV in UTF-8");
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  if (text.find('\n') == std::string::npos) std::ranges::replace(text, '\r', '\n');
  std::vector<TableLine> lines;
  std::istringstream stream(text);
  int number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++number;
    if (line.ends_with('\r')) line.pop_back();
    const std::string content = trimmed(withoutComment(line));
    if (content.find_first_not_of(",; \t") != std::string::npos)
      lines.push_back({content, file.string() + ", line " + std::to_string(number)});
  }
  return lines;
}

/// Form of a table by its first line; has no columns if that line already names a drive.
struct TableForm {
  char separator = ',';
  std::vector<std::string> columns{};  // by their keys, as they stand where they have none
};

TableForm formOf(const TableLine& first) {
  TableForm form;
  for (const char separator : kSeparators) {
    std::vector<std::string> columns = fieldsOf(first, separator);
    bool names_drives = false;
    for (std::string& column : columns) {
      const std::string key = columnKey(column);
      names_drives = names_drives || key == "path" || key == "scene";
      if (!key.empty()) column = key;
    }
    if (names_drives && columns.size() > form.columns.size()) form = {separator, std::move(columns)};
  }
  return form;
}

/// The path of a line in a list without columns.
std::string barePath(TableLine line) {
  line.text.erase(line.text.find_last_not_of(",; \t") + 1);
  for (const char separator : kSeparators)
    if (fieldsOf(line, separator).size() > 1)
      throw UsageError(line.where + ": '" + printable(line.text, 80) +
                       "' has several fields, and the first line names no column 'path'; begin with one, as path,name, "
                       "or put quotes around a path that has a comma");
  return fieldsOf(line, ',').front();
}

std::vector<std::string> wordsOf(const std::string& field) {
  std::istringstream stream(field);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

/// A row of the table by its columns. Columns whose names have a dot are parameters of the row's own set.
struct Row {
  ManifestFields fields;
  ParameterSet set;
};

Row rowOf(const std::vector<std::string>& columns, std::vector<std::string> values, const std::string& where) {
  while (values.size() > columns.size() && values.back().empty()) values.pop_back();
  if (values.size() != columns.size())
    throw UsageError(where + ": has " + std::to_string(values.size()) + " fields, the first line has " +
                     std::to_string(columns.size()));
  Row row{.fields = {.where = where}, .set = {.name = "default"}};
  for (std::size_t i = 0; i < columns.size(); ++i) {
    const std::string& column = columns[i];
    if (values[i].empty() || column.empty()) continue;
    if (column == "set")
      row.set.name = values[i];
    else if (std::ranges::count(column, '.') > 0)
      row.set.assignments.push_back(column + "=" + values[i]);
    else if (column == "seeds")
      row.fields.words[column] = wordsOf(values[i]);
    else
      row.fields.words[column] = {values[i]};
  }
  requireName(row.set.name, where);
  return row;
}

/// Adds a set. Sets of the same name must have the same parameters in all rows.
void addSet(Manifest& manifest, const ParameterSet& set, const std::string& where) {
  const auto known = std::ranges::find(manifest.sets, set.name, &ParameterSet::name);
  if (known == manifest.sets.end())
    manifest.sets.push_back(set);
  else if (known->assignments != set.assignments)
    throw UsageError(where + ": set '" + set.name +
                     "' has other parameters than in a line before; write another name in the column 'set'");
}

constexpr const char* kForm =
    "; a manifest has root, baseline_set, dataset, published, [defaults], [sets.NAME] and [[drives]]";

std::string wordOf(const toml::node& node) {
  if (const auto text = node.value_exact<std::string>()) return *text;
  std::ostringstream text;
  node.visit([&](const auto& value) { text << value; });
  return text.str();
}

/// The position of a key, or of an element of a list. A table that dotted keys make has none of its own.
TomlPosition positionOf(const auto& key_or_element, const std::filesystem::path& file) {
  return {file.string(), key_or_element.source().begin.line};
}

std::string stringOf(const toml::node& node, const toml::key& key, const std::filesystem::path& file) {
  const auto text = node.value_exact<std::string>();
  if (!text) failAt(positionOf(key, file), "'" + std::string(key.str()) + "' must be a text in quotes");
  return *text;
}

const toml::array& listOf(const toml::node& node, const toml::key& key, const std::filesystem::path& file) {
  const toml::array* const list = node.as_array();
  if (list == nullptr) failAt(positionOf(key, file), "'" + std::string(key.str()) + "' is no list" + kForm);
  return *list;
}

/// Adds the keys of a table, each with its values as words.
void addFields(ManifestFields& fields, const toml::table& table, const std::filesystem::path& file) {
  for (const auto& [key, node] : table) {
    const std::string name(key.str());
    if (node.is_table())
      failAt(positionOf(key, file), "'" + printable(name) + "' is a table; parameters stand in [sets.NAME]");
    auto& words = fields.words[name];
    words.clear();
    if (const toml::array* const values = node.as_array())
      for (const auto& value : *values) words.push_back(wordOf(value));
    else
      words.push_back(wordOf(node));
  }
}

void addAssignments(ParameterSet& set, const toml::table& table, const std::string& prefix) {
  for (const auto& [key, node] : table) {
    const std::string name = prefix + std::string(key.str());
    if (const toml::table* const section = node.as_table())
      addAssignments(set, *section, name + ".");
    else
      set.assignments.push_back(name + "=" + wordOf(node));
  }
}

/// Sets in the order of the file, which a TOML table does not keep.
std::vector<ParameterSet> setsOf(const toml::table& table, const std::filesystem::path& file) {
  std::map<std::pair<toml::source_index, toml::source_index>, ParameterSet> by_place;
  for (const auto& [key, node] : table) {
    const TomlPosition position = positionOf(key, file);
    const toml::table* const parameters = node.as_table();
    if (parameters == nullptr) failAt(position, "a set of parameters is a table: [sets.NAME]");
    ParameterSet set{.name = std::string(key.str())};
    requireName(set.name, position.text());
    addAssignments(set, *parameters, "");
    by_place[{key.source().begin.line, key.source().begin.column}] = std::move(set);
  }
  std::vector<ParameterSet> sets;
  for (auto& [place, set] : by_place) sets.push_back(std::move(set));
  return sets;
}

void addEntries(Manifest& manifest, const toml::array& drives, const toml::table& defaults) {
  for (const auto& node : drives) {
    const TomlPosition position = positionOf(node, manifest.file);
    const toml::table* const table = node.as_table();
    if (table == nullptr) failAt(position, std::string("a drive is a table") + kForm);
    ManifestFields fields{.where = position.text()};
    addFields(fields, defaults, manifest.file);
    addFields(fields, *table, manifest.file);
    for (ManifestEntry& entry : manifestEntries(fields)) manifest.entries.push_back(std::move(entry));
  }
}

}  // namespace

Manifest readManifestCsv(const std::filesystem::path& file, const std::string& text) {
  Manifest manifest{.file = file};
  const std::vector<TableLine> lines = linesOf(file, text);
  if (lines.empty()) return manifest;
  const TableForm form = formOf(lines.front());
  const bool bare = form.columns.empty();
  for (std::size_t i = bare ? 0 : 1; i < lines.size(); ++i) {
    const TableLine& line = lines[i];
    const Row row = bare ? rowOf({"path"}, {barePath(line)}, line.where)
                         : rowOf(form.columns, fieldsOf(line, form.separator), line.where);
    addSet(manifest, row.set, line.where);
    for (ManifestEntry& entry : manifestEntries(row.fields)) {
      entry.sets = {row.set.name};
      manifest.entries.push_back(std::move(entry));
    }
  }
  return manifest;
}

Manifest readManifestToml(const std::filesystem::path& file, const std::string& text) {
  const toml::table document = parseToml(text, file.string());
  Manifest manifest{.file = file};
  toml::table defaults;
  const toml::array* drives = nullptr;
  for (const auto& [key, node] : document) {
    const std::string name(key.str());
    const toml::table* const table = node.as_table();
    if (name == "root")
      manifest.root = stringOf(node, key, file);
    else if (name == "baseline_set")
      manifest.baseline_set = stringOf(node, key, file);
    else if (name == "dataset")
      manifest.dataset = stringOf(node, key, file);
    else if (name == "published")
      manifest.published = file.parent_path() / expandedPath(stringOf(node, key, file));
    else if (name == "drives")
      drives = &listOf(node, key, file);
    else if (name == "defaults" && table != nullptr)
      defaults = *table;
    else if (name == "sets" && table != nullptr)
      manifest.sets = setsOf(*table, file);
    else
      failAt(positionOf(key, file), "unknown key '" + printable(name) + "'" + kForm);
  }
  if (drives != nullptr) addEntries(manifest, *drives, defaults);
  return manifest;
}

}  // namespace motorcade
