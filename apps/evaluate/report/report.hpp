#pragma once

#include <string>

#include "apps/evaluate/measures/evaluation.hpp"

namespace motorcade {

/// The evaluation as a table to read, final beside online, of at most 100 columns; the legend stands at its end.
std::string tableOf(const Evaluation& evaluation);
/// Explains the measures of the table.
std::string legendOf(const Evaluation& evaluation);
/// The same with every number, as JSON.
std::string jsonOf(const Evaluation& evaluation);

}  // namespace motorcade
