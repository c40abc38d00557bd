#include "io/bag/bag_topics.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>

#include "io/bag/sensor_messages.hpp"
#include "io/files/errors.hpp"
#include "io/files/file_names.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

constexpr std::size_t kMostCharacters = 200;  // of a name, as it is told

bool isOfImages(const BagTopic& topic) {
  const auto kind = sensorMessageNamed(topic.type);
  return kind && *kind != SensorMessage::kCameraInfo;
}

/// Words that tell the sides apart in the names of topics.
constexpr std::array<std::pair<std::string_view, std::string_view>, 6> kSideWords{{{"left", "right"},
                                                                                   {"cam0", "cam1"},
                                                                                   {"cam_0", "cam_1"},
                                                                                   {"image_00", "image_01"},
                                                                                   {"infra1", "infra2"},
                                                                                   {"image_02", "image_03"}}};

std::optional<ImageTopics> likelyPair(const std::vector<BagTopic>& topics) {
  for (const BagTopic& left : topics) {
    if (!isOfImages(left)) continue;
    for (const auto& [left_word, right_word] : kSideWords) {
      const auto begin = left.name.find(left_word);
      if (begin == std::string::npos) continue;
      std::string name = left.name;
      name.replace(begin, left_word.size(), right_word);
      if (std::ranges::any_of(topics, [&](const BagTopic& right) { return right.name == name && isOfImages(right); }))
        return ImageTopics{left.name, name};
    }
  }
  return std::nullopt;
}

std::string nameOf(const BagTopic& topic) { return printable(topic.name, kMostCharacters); }

/// The option that a user is likely to want, in parentheses; empty where no two topics look like a pair's.
std::string likelyOption(const std::vector<BagTopic>& topics) {
  const auto pair = likelyPair(topics);
  if (!pair) return "";
  return " (perhaps --topics " + shellWord(printable(pair->left + "," + pair->right, 2 * kMostCharacters)) + ")";
}

}  // namespace

ImageTopics parseImageTopics(const std::string& text) {
  const auto comma = text.find(',');
  ImageTopics topics{text.substr(0, comma), comma == std::string::npos ? "" : text.substr(comma + 1)};
  if (topics.left.empty() || topics.right.empty() || topics.right.find(',') != std::string::npos)
    throw UsageError("--topics " + text + ": write LEFT,RIGHT, the topics of both cameras' images");
  if (topics.left == topics.right) throw UsageError("--topics " + text + ": names the same topic twice");
  return topics;
}

std::string topicsText(const std::vector<BagTopic>& topics) {
  constexpr std::size_t kMostTopics = 100;
  const std::size_t shown = std::min(topics.size(), kMostTopics);
  std::size_t longest = 0;
  for (std::size_t i = 0; i < shown; ++i) longest = std::max(longest, nameOf(topics[i]).size());
  std::string text;
  for (std::size_t i = 0; i < shown; ++i) {
    std::string name = nameOf(topics[i]);
    name.resize(longest, ' ');
    text += "\n  " + name + "  " + printable(topics[i].type, kMostCharacters);
    if (topics[i].messages > 0) text += ", " + std::to_string(topics[i].messages) + " messages";
  }
  if (topics.size() > shown) text += "\n  and " + std::to_string(topics.size() - shown) + " more";
  return text;
}

void failWithTopics(BagReader& bag, const std::string& what) {
  try {
    if (bag.topics().empty())
      while (bag.next()) continue;
  } catch (const InputError&) {  // the topics up to the damage
  }
  if (bag.topics().empty()) throw UsageError(what + "; it has no topics");
  throw UsageError(what + likelyOption(bag.topics()) + "; it has" + topicsText(bag.topics()));
}

}  // namespace motorcade
