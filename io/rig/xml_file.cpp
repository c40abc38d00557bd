#include "io/rig/xml_file.hpp"

#include <algorithm>
#include <sstream>
#include <string_view>
#include <utility>

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

}  // namespace motorcade
