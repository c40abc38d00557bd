#pragma once

#include <nlohmann/json_fwd.hpp>

#include "apps/evaluate/existence_measures.hpp"

namespace motorcade {

/// `rows`, `brier`, `largest_gap` and `tenths`; null for what cannot be told from so few rows.
nlohmann::ordered_json jsonOf(const ExistenceErrors& errors);

}  // namespace motorcade
