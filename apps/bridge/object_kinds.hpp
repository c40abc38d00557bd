#pragma once

#include <vector>

#include "motorcade/motorcade.hpp"

namespace motorcade {

struct KindShare {
  Result::Kind kind = Result::Kind::kUnknown;
  double probability = 0;
};

/// The kinds that an object may be: the one that the tracker names, and unknown with the rest. The shares sum to one.
/// Where none is named, the tracker's probability is that of a kind it does not tell, and all is unknown.
std::vector<KindShare> kindShares(const Result::Object& object);

}  // namespace motorcade
