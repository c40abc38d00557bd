#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace motorcade {

/// The order in which people count: `img2` before `img10`. Names that differ only in leading zeros are ordered as plain
/// text.
bool naturallyBefore(std::string_view a, std::string_view b);

struct NaturalOrder {
  bool operator()(const std::filesystem::path& a, const std::filesystem::path& b) const {
    return naturallyBefore(a.native(), b.native());
  }
};

/// All entries of a folder, in natural order. Throws std::filesystem::filesystem_error.
std::vector<std::filesystem::path> listFolder(const std::filesystem::path& folder);
/// The same, empty where there is no such folder.
std::vector<std::filesystem::path> listFolderIfThere(const std::filesystem::path& folder);

/// A word that a shell reads back when a message is pasted, quoted where it has more than plain letters.
inline std::string shellWord(const std::string& text) {
  constexpr const char* kPlain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789/._-+,:=@%";
  if (!text.empty() && text.find_first_not_of(kPlain) == std::string::npos) return text;
  std::string quoted = "'";
  for (const char letter : text) {
    if (letter == '\'') quoted += "'\\'";
    quoted.push_back(letter);
  }
  quoted.push_back('\'');
  return quoted;
}

}  // namespace motorcade
