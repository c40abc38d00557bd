#pragma once

#include <string>
#include <vector>

#include "apps/check/epipolar_picture.hpp"
#include "apps/watch/input_check.hpp"

namespace motorcade {

/// Content of a page of `check`.
struct CheckedInput {
  std::string sequence;
  StereoCamera camera;
  const InputCheck* check = nullptr;
  std::vector<Finding> findings;
  std::vector<MatchedPair> worst;  // the pairs whose rows agree least
};

/// A whole HTML page in one file: the input, the findings and their remedies, pictures of the pairs, and all
/// measurements.
std::string checkPage(const CheckedInput& input);

}  // namespace motorcade
