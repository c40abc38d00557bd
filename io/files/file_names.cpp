#include "io/files/file_names.hpp"

#include <algorithm>
#include <system_error>

namespace motorcade {
namespace {

namespace fs = std::filesystem;

bool beginsWithDigit(std::string_view text) { return !text.empty() && text.front() >= '0' && text.front() <= '9'; }

/// Takes the digits at the beginning of a text, and returns them without leading zeros.
std::string_view takeNumber(std::string_view& text) {
  const std::size_t end = std::min(text.find_first_not_of("0123456789"), text.size());
  std::string_view number = text.substr(0, end);
  text.remove_prefix(end);
  number.remove_prefix(std::min(number.find_first_not_of('0'), number.size()));
  return number;
}

/// Negative where `a` comes before `b`, positive where it comes after it.
int compare(std::string_view a, std::string_view b) {
  while (!a.empty() && !b.empty()) {
    if (beginsWithDigit(a) && beginsWithDigit(b)) {
      const std::string_view x = takeNumber(a), y = takeNumber(b);
      if (x.size() != y.size()) return x.size() < y.size() ? -1 : 1;
      if (const int order = x.compare(y); order != 0) return order;
    } else {
      if (const int order = a.substr(0, 1).compare(b.substr(0, 1)); order != 0) return order;
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  return static_cast<int>(b.empty()) - static_cast<int>(a.empty());
}

std::vector<fs::path> inNaturalOrder(fs::directory_iterator entries) {
  std::vector<fs::path> paths;
  for (const auto& entry : entries) paths.push_back(entry.path());
  std::ranges::sort(paths, NaturalOrder{});
  return paths;
}

}  // namespace

bool naturallyBefore(std::string_view a, std::string_view b) {
  const int order = compare(a, b);
  return order != 0 ? order < 0 : a < b;
}

std::vector<fs::path> listFolder(const fs::path& folder) { return inNaturalOrder(fs::directory_iterator(folder)); }

std::vector<fs::path> listFolderIfThere(const fs::path& folder) {
  std::error_code none;
  return inNaturalOrder(fs::directory_iterator(folder, none));
}

}  // namespace motorcade
