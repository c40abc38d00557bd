#include "core/edit_distance.hpp"

#include <algorithm>
#include <numeric>

namespace motorcade {

std::size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, diagonal + 1});
    }
  }
  return row[b.size()];
}

std::string nearestName(std::string_view word, const std::vector<std::string>& names) {
  constexpr std::size_t kMostLetters = 80;  // a whole file may have come as a word
  word = word.substr(0, kMostLetters);
  const auto distance = [&](const std::string& name) { return editDistance(word, name); };
  const auto nearest = std::ranges::min_element(names, {}, distance);
  if (nearest == names.end() || 2 * distance(*nearest) > std::max(word.size(), nearest->size())) return {};
  return *nearest;
}

}  // namespace motorcade
