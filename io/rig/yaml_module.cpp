#include "io/rig/yaml_module.hpp"

#include <exception>
#include <map>
#include <new>
#include <optional>
#include <sstream>
#include <utility>

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/mark.h>
#include <yaml-cpp/parser.h>

namespace motorcade {
namespace {

// The largest file that is read, a megabyte of numbers, has fewer; copies may add a few times as much.
constexpr std::size_t kMostNodes = std::size_t{1} << 18, kMostText_bytes = std::size_t{1} << 21;
constexpr std::size_t kDeepest = 64;

/// A construct that no calibration has.
struct NoCalibration {
  int line;
  const char* problem;
};

int lineOf(const YAML::Mark& mark) { return mark.is_null() ? 0 : mark.line + 1; }

/// Builds the tree from the parser's events, from the leaves up.
class TreeBuilder : public YAML::EventHandler {
 public:
  YamlNode takeRoot() { return std::move(root_); }

  void OnDocumentStart(const YAML::Mark&) override {}
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override { add(node(Kind::kEmpty, mark), anchor); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor, const std::string& text) override {
    add(node(Kind::kScalar, mark, text), anchor);
  }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto anchored = anchors_.find(anchor);
    if (anchored == anchors_.end()) throw NoCalibration{lineOf(mark), "a part holds itself"};
    add(copyOf(anchored->second, lineOf(mark)), YAML::NullAnchor);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    open(Kind::kSequence, mark, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    open(Kind::kMap, mark, anchor);
  }
  void OnMapEnd() override { close(); }

 private:
  using Kind = YamlNode::Kind;

  /// A list or map whose end has not come yet.
  struct Open {
    YamlNode node;
    YAML::anchor_t anchor;
    bool key_came = false;
    std::optional<std::string> key{};  // where it is a scalar
  };

  void spend(int line, std::size_t text_bytes) {
    text_bytes_ += text_bytes;
    if (++nodes_ > kMostNodes || text_bytes_ > kMostText_bytes) throw NoCalibration{line, "it has too many parts"};
  }
  YamlNode node(Kind kind, const YAML::Mark& mark, const std::string& text = {}) {
    spend(lineOf(mark), text.size());
    return {.kind = kind, .line = lineOf(mark), .text = text};
  }
  /// Each copy counts against the bounds, so that aliases of aliases come to an end.
  YamlNode copyOf(const YamlNode& original, int line) {
    spend(line, original.key.size() + original.text.size());
    YamlNode copy{.kind = original.kind, .line = original.line, .key = original.key, .text = original.text};
    for (const YamlNode& part : original.parts) copy.parts.push_back(copyOf(part, line));
    return copy;
  }
  void open(Kind kind, const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (open_.size() == kDeepest) throw NoCalibration{lineOf(mark), "it nests too deep"};
    open_.push_back({.node = node(kind, mark), .anchor = anchor});
  }
  void close() {
    Open closed = std::move(open_.back());
    open_.pop_back();
    add(std::move(closed.node), closed.anchor);
  }
  void add(YamlNode part, YAML::anchor_t anchor);

  std::vector<Open> open_;
  std::map<YAML::anchor_t, YamlNode> anchors_;
  YamlNode root_;
  std::size_t nodes_ = 0, text_bytes_ = 0;
};

void TreeBuilder::add(YamlNode part, YAML::anchor_t anchor) {
  if (anchor != YAML::NullAnchor) anchors_.insert_or_assign(anchor, copyOf(part, part.line));
  if (open_.empty()) {
    root_ = std::move(part);
    return;
  }
  Open& parent = open_.back();
  const bool is_key = parent.node.kind == Kind::kMap && !parent.key_came;
  parent.key_came = is_key;
  if (is_key) {
    parent.key = part.kind == Kind::kScalar ? std::optional(std::move(part.text)) : std::nullopt;
  } else if (parent.node.kind == Kind::kSequence || parent.key) {
    part.key = std::exchange(parent.key, std::nullopt).value_or("");
    parent.node.parts.push_back(std::move(part));
  }
}

void parse(std::string_view text, YamlAnswer& answer) {
  std::istringstream stream{std::string(text)};
  TreeBuilder builder;
  YAML::Parser(stream).HandleNextDocument(builder);
  answer.root = builder.takeRoot();
}

}  // namespace

extern "C" [[gnu::visibility("default")]] void motorcade_yaml_1(std::string_view text, YamlAnswer& answer) noexcept {
  try {
    parse(text, answer);
  } catch (const NoCalibration& found) {
    answer = {.outcome = YamlAnswer::Outcome::kNoCalibration, .line = found.line, .problem = found.problem};
  } catch (const YAML::Exception& error) {
    answer = {.outcome = YamlAnswer::Outcome::kNoYaml, .line = lineOf(error.mark), .problem = error.msg};
  } catch (const std::bad_alloc&) {
    answer.outcome = YamlAnswer::Outcome::kNoCalibration;
    answer.problem = "out of memory";  // short enough to need none
  } catch (const std::exception& error) {
    answer = {.outcome = YamlAnswer::Outcome::kNoYaml, .problem = error.what()};
  }
}

}  // namespace motorcade
