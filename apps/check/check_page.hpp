#pragma once

#include <span>
#include <string>
#include <vector>

#include "apps/watch/epipolar_matching.hpp"
#include "apps/watch/input_check.hpp"
#include "apps/watch/pair_geometry.hpp"
#include "core/image.hpp"
#include "io/images/image_file.hpp"

namespace motorcade {

/// A pair with the points that were seen in both images.
struct MatchedPair {
  FrameId frame;
  Image left, right;
  std::span<const EpipolarMatch> matches;
};

/// Both images side by side, with lines along rows from points on the left to their partners on the right. Where a
/// partner lies above or below the line, a colored bar shows the distance, enlarged as the legend says.
RgbImage drawEpipolarLines(const MatchedPair& pair);

/// The left image with the row errors of all matches as thin bars. Arrows show the row errors that the measured
/// geometry predicts across the image. A scale is added.
RgbImage drawRowErrors(const Image& left, std::span<const EpipolarMatch> matches, const PairGeometry& geometry,
                       const StereoCamera& camera);

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
