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

/// Throws UsageError that lists all topics of a bag and the likely ones. Reads on where the bag has not listed them
/// yet.
[[noreturn]] void failWithTopics(BagReader& bag, const std::string& what);

}  // namespace motorcade
