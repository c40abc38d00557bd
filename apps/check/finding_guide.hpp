#pragma once

#include <span>
#include <string>
#include <string_view>

#include "apps/watch/input_check.hpp"

namespace motorcade {

/// The meaning of a finding for results, and the user's remedy.
struct FindingGuide {
  std::string_view title, meaning, mend;
};

/// The guide by the finding's name; general words for one that has none of its own.
FindingGuide guideTo(std::string_view finding);

/// True when one of the findings makes results worthless.
bool isWorthless(std::span<const Finding> findings);

/// A sentence on what `run` does with these findings.
std::string verdictOnRun(std::span<const Finding> findings);

}  // namespace motorcade
