#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace motorcade {

/// Levenshtein's distance: the number of letters to change, to add or to take away.
std::size_t editDistance(std::string_view a, std::string_view b);

/// The name that a word likely means; empty where more than half of the letters differ from every name.
std::string nearestName(std::string_view word, const std::vector<std::string>& names);

}  // namespace motorcade
