#pragma once

#include <vector>

#include "apps/evaluate/comparison/object_matching.hpp"
#include "apps/evaluate/measures/reliability.hpp"

namespace motorcade {

/// Reliability of the existence probability. A hit is a row on a label that moves at some time. Counts all rows but
/// those in an area that the labels leave open.
Reliability existenceErrors(const std::vector<ComparedFrame>& frames);

}  // namespace motorcade
