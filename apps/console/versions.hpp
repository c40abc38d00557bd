#pragma once

#include <string>
#include <utility>
#include <vector>

namespace motorcade {

/// What the program is made of, by name: itself, how it was built, and its libraries.
std::vector<std::pair<std::string, std::string>> versions();

/// The same as lines for the user; the first one has the program's name and version.
std::string versionsText();

}  // namespace motorcade
