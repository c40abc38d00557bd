#include <fmt/format.h>

#include "apps/html/html_page.hpp"
#include "apps/merge/result_tables.hpp"

namespace motorcade {
namespace {

/// Text of a cell, without the characters that would end a cell of a Markdown table.
std::string cellText(const std::string& text) {
  std::string cell;
  for (const char c : text) {
    if (c == '|') cell += '\\';
    cell += c == '\n' ? ' ' : c;
  }
  return cell;
}

std::string classOf(bool is_name, Tone tone) {
  std::string classes = is_name ? "" : "number";
  if (tone != Tone::kNone)
    classes.append(classes.empty() ? "" : " ").append(tone == Tone::kBetter ? "better" : "worse");
  return classes.empty() ? "" : " class=\"" + classes + "\"";
}

}  // namespace

std::string markdownOf(const ResultTable& table) {
  const auto line = [](const std::vector<std::string>& cells) {
    std::string text = "|";
    for (const std::string& cell : cells) text += fmt::format(" {} |", cellText(cell));
    return text + "\n";
  };
  std::string text = fmt::format("## {}\n\n", table.title);
  text += line(table.heads) + line(std::vector<std::string>(table.heads.size(), "---"));
  for (const auto& row : table.rows) text += line(row);
  return text + "\n";
}

std::string htmlOf(const ResultTable& table) {
  const auto cells = [&](const std::vector<std::string>& row, const char* element, const std::vector<Tone>& tones) {
    std::string html = "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i)
      html += fmt::format("<{0}{1}>{2}</{0}>", element,
                          classOf(i < table.names, i < tones.size() ? tones[i] : Tone::kNone), escaped(row[i]));
    return html + "</tr>\n";
  };
  std::string html = "<div class=\"wide\"><table>\n<thead>" + cells(table.heads, "th", {}) + "</thead>\n<tbody>\n";
  for (std::size_t row = 0; row < table.rows.size(); ++row)
    html += cells(table.rows[row], "td", row < table.tones.size() ? table.tones[row] : std::vector<Tone>());
  return html + "</tbody></table></div>\n";
}

}  // namespace motorcade
