#pragma once

#include <string_view>

namespace motorcade {

/// What a finding means for results, and what a user does about it.
struct FindingGuide {
  std::string_view title, meaning, mend;
};

/// By the finding's name; general words for one that has none of its own.
FindingGuide guideTo(std::string_view finding);

}  // namespace motorcade
