#pragma once

#include <span>
#include <string>
#include <string_view>

#include "apps/watch/input_check.hpp"

namespace motorcade {

/// What a finding means for results, and what a user does about it.
struct FindingGuide {
  std::string_view title, meaning, mend;
};

/// By the finding's name; general words for one that has none of its own.
FindingGuide guideTo(std::string_view finding);

/// Results with one of these would be.
bool isWorthless(std::span<const Finding> findings);

/// A sentence on what `run` does with these findings.
std::string verdictOnRun(std::span<const Finding> findings);

}  // namespace motorcade
