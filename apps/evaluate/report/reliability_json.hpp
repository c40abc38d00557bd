#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/evaluate/measures/reliability.hpp"

namespace motorcade {

/// `rows`, `brier`, `largest_gap` and `tenths`; null for values that so few rows cannot tell. `hits` is the key of the
/// probability's event, such as "real".
nlohmann::ordered_json jsonOf(const Reliability& reliability, const char* hits);

}  // namespace motorcade
