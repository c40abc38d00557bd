#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace motorcade {

/// Levenshtein's distance: how many letters to change, to add or to take away.
std::size_t editDistance(std::string_view a, std::string_view b);

/// The name that was likely meant by a word; empty where none resembles it: more than half of the letters are others.
std::string nearestName(std::string_view word, const std::vector<std::string>& names);

}  // namespace motorcade
