#pragma once

#include <string>

namespace motorcade {

/// Expands a path as a shell does: ~ at its beginning is the home folder, $NAME and ${NAME} are variables of the
/// environment. Variables that are not set stay as they are.
std::string expandedPath(const std::string& text);

/// The first variable that was left in an expanded path, as $NAME; empty where there is none.
std::string unsetVariable(const std::string& expanded);

}  // namespace motorcade
