#pragma once

#include <string>

#include "apps/evaluate/measures/evaluation.hpp"

/// Parts of the table that `tableOf` puts together.
namespace motorcade {

/// Appends a formatted text.
[[gnu::format(printf, 2, 3)]] void print(std::string& text, const char* format, ...);

/// The run, its sequence and its truth.
void printHead(std::string& text, const Evaluation& evaluation);
/// Errors of the camera's path, as a whole and over segments.
void printCamera(std::string& text, const Evaluation& evaluation);
/// Errors of the objects' motions and speeds.
void printMotions(std::string& text, const Evaluation& evaluation);

}  // namespace motorcade
