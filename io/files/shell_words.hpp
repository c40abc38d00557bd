#pragma once

#include <string>

namespace motorcade {

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
