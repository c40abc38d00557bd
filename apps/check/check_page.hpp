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

/// A whole HTML page that stands in one file: what was looked at, what was found and how to mend it, pictures of the
/// pairs, and all that was measured.
std::string checkPage(const CheckedInput& input);

}  // namespace motorcade
