#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace motorcade {

/// Adds `motorcade run`. When the user asks for it, `action` becomes what to do; it gives the exit code.
void addRunCommand(CLI::App& app, std::function<int()>& action);

}  // namespace motorcade
