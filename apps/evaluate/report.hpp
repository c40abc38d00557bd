#pragma once

#include <string>

#include "apps/evaluate/evaluation.hpp"

namespace motorcade {

/// The evaluation as a table to read, final beside online.
std::string tableOf(const Evaluation& evaluation);
/// The same with every number, as JSON.
std::string jsonOf(const Evaluation& evaluation);

}  // namespace motorcade
