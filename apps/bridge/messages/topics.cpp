#include "apps/bridge/messages/topics.hpp"

#include <algorithm>
#include <sstream>

#include "io/files/errors.hpp"
#include "io/files/text_file.hpp"

namespace motorcade {
namespace {

Topic topicNamed(const std::string& name) {
  const auto found = std::ranges::find(kTopicNames, name, [](const TopicNames& names) { return names.option; });
  if (found != kTopicNames.end()) return static_cast<Topic>(found - kTopicNames.begin());
  std::string known;
  for (const TopicNames& names : kTopicNames) known += (known.empty() ? "" : ", ") + std::string(names.option);
  throw UsageError("--topics: no topic is called '" + printable(name) + "'; write some of " + known +
                   " with commas between them");
}

}  // namespace

std::string rosNamesOf(const std::set<Topic>& topics) {
  std::string text;
  std::size_t left = topics.size();
  for (const Topic topic : topics) {
    text += std::string("/") + kTopicNames[static_cast<std::size_t>(topic)].ros;
    --left;
    if (left > 0) text += left == 1 ? " and " : ", ";
  }
  return text;
}

std::set<Topic> topicsOf(const std::string& names) {
  std::set<Topic> topics;
  std::istringstream stream(names + ",");
  for (std::string name; std::getline(stream, name, ',');) topics.insert(topicNamed(name));
  return topics;
}

}  // namespace motorcade
