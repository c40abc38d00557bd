#pragma once

#include <cstddef>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

namespace motorcade {

/// Direction in which a value is better.
enum class Better { kLower, kHigher, kNeither };

/// A number that every result of a batch may have, and its position in a file.
struct Measure {
  std::string_view name;   // of its column, with its unit
  std::string_view part;   // JSON pointer in evaluation.json, or behind `summary:` in summary.json
  std::string_view value;  // its JSON pointer in that part
  std::string_view count;  // in that part, must not be zero, or the value means nothing; empty for none
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

/// The name of a measure (`allMeasures`) for readers, with its unit in brackets: `camera_rpe_t_rmse_m` is "camera RPE
/// of translation, RMSE [m]". It is made of the key's words, so that a new measure has one, too.
std::string readableName(std::string_view measure);

}  // namespace motorcade
