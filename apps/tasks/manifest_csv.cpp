#include <algorithm>
#include <sstream>

#include "apps/tasks/manifest_fields.hpp"
#include "io/errors.hpp"
#include "io/text_file.hpp"

namespace motorcade {
namespace {

/// The fields of a line of a table (RFC 4180): one with a comma stands between quotes, in which two quotes are one.
std::vector<std::string> fieldsOf(const std::string& line, const std::string& where) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (c == '"' && quoted && i + 1 < line.size() && line[i + 1] == '"')
      fields.back() += line[++i];
    else if (c == '"')
      quoted = !quoted;
    else if (c == ',' && !quoted)
      fields.emplace_back();
    else
      fields.back() += c;
  }
  if (quoted) throw UsageError(where + ": a quote is not closed");
  for (std::string& field : fields) field = trimmed(field);
  return fields;
}

std::vector<std::string> wordsOf(const std::string& field) {
  std::istringstream stream(field);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

/// A row of the table by its columns: those whose names have a dot are parameters of the row's own set.
struct Row {
  ManifestFields fields;
  ParameterSet set;
};

Row rowOf(const std::vector<std::string>& columns, const std::vector<std::string>& values, const std::string& where) {
  if (values.size() != columns.size())
    throw UsageError(where + ": has " + std::to_string(values.size()) + " fields, the first line has " +
                     std::to_string(columns.size()));
  Row row{.fields = {.where = where}, .set = {.name = "default"}};
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (values[i].empty()) continue;
    const std::string& column = columns[i];
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

/// A set of one name has the same parameters in all rows.
void addSet(Manifest& manifest, const ParameterSet& set, const std::string& where) {
  const auto known = std::ranges::find(manifest.sets, set.name, &ParameterSet::name);
  if (known == manifest.sets.end())
    manifest.sets.push_back(set);
  else if (known->assignments != set.assignments)
    throw UsageError(where + ": set '" + set.name +
                     "' has other parameters than in a line before; write another name in the column 'set'");
}

}  // namespace

Manifest readManifestCsv(const std::filesystem::path& file, const std::string& text) {
  Manifest manifest{.file = file};
  std::vector<std::string> columns;
  std::istringstream lines(text);
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    const std::string where = file.string() + ", line " + std::to_string(++number);
    if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    if (trimmed(line).empty() || line.starts_with('#')) continue;
    const auto fields = fieldsOf(line, where);
    if (columns.empty()) {
      columns = fields;
      continue;
    }
    Row row = rowOf(columns, fields, where);
    addSet(manifest, row.set, where);
    ManifestEntry entry = manifestEntry(row.fields);
    entry.sets = {row.set.name};
    manifest.entries.push_back(std::move(entry));
  }
  return manifest;
}

}  // namespace motorcade
