#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/evaluate/measures/reliability.hpp"

namespace motorcade {

/// `rows`, `brier`, `largest_gap` and `tenths`; null for what cannot be told from so few rows. `hits` is the key of
/// what the probability is of, such as "real".
nlohmann::ordered_json jsonOf(const Reliability& reliability, const char* hits);

}  // namespace motorcade
