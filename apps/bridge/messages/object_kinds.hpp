#pragma once

#include <vector>

#include "motorcade/motorcade.hpp"

namespace motorcade {

struct KindShare {
  Result::Kind kind = Result::Kind::kUnknown;
  double probability = 0;
};

/// Possible kinds of an object: the one that the tracker names, and unknown with the rest. The shares sum to one. All
/// is unknown where no kind is named: the tracker's probability is then that of a kind that it does not publish.
std::vector<KindShare> kindShares(const Result::Object& object);

}  // namespace motorcade
