#pragma once

#include <functional>

#include <CLI/CLI.hpp>

namespace motorcade {

/// Registers `synth OUT --scene NAME`; when it is parsed, sets `action` to what the program shall do, which returns the
/// exit code.
void addSynthCommand(CLI::App& app, std::function<int()>& action);

}  // namespace motorcade
