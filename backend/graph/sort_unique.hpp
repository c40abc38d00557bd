#pragma once

#include <algorithm>
#include <vector>

namespace motorcade {

/// Sorts the items and keeps one of each.
template <class T>
void sortUnique(std::vector<T>& items) {
  std::ranges::sort(items);
  items.erase(std::unique(items.begin(), items.end()), items.end());
}

}  // namespace motorcade
