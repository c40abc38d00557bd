#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace motorcade {

/// Direction in which a value is better.
enum class Better { kLower, kHigher, kNeither };

/// A number that every result of a batch may have, and its position in a file.
struct Measure {
  std::string_view name;   // of its column, with its unit
  std::string_view path;   // JSON pointer in evaluation.json, or behind `summary:` in summary.json
  std::string_view guard;  // JSON pointer of a count that must not be zero, or the value means nothing; empty for none
  Better better = Better::kNeither;
};

/// All of them, in the order of the columns.
std::span<const Measure> allMeasures();
/// The place of a measure by its name, which is one of those above.
std::size_t measureIndex(std::string_view name);

/// Not a number where a result has none.
inline constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();
using MeasureValues = std::vector<double>;

/// The values of a result; either file's content may be null. Values that are computed from several stay empty here.
MeasureValues measuresOf(const nlohmann::json& evaluation, const nlohmann::json& summary);

}  // namespace motorcade
