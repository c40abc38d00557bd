#pragma once

#include <string>
#include <vector>

#include "io/bag/bag_reader.hpp"

/// The topics of a bag, as a user names them.
namespace motorcade {

struct ImageTopics {
  std::string left, right;
};

/// Reads `LEFT,RIGHT`; throws UsageError.
ImageTopics parseImageTopics(const std::string& text);

/// A line for each topic, beginning with the line's end before it.
std::string topicsText(const std::vector<BagTopic>& topics);

/// Throws UsageError with all topics of a bag, and those that are likely meant; reads on where the bag does not list
/// them before.
[[noreturn]] void failWithTopics(BagReader& bag, const std::string& what);

}  // namespace motorcade
