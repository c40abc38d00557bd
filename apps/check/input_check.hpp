#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "apps/check/pair_geometry.hpp"
#include "core/messages.hpp"
#include "frontend/features/corner_detector.hpp"

namespace motorcade {

/// What is wrong with the pairs of a rig, in a sentence that says what was measured, what it means and how to mend it.
struct Finding {
  std::string name;  // one word, as in docs/formats.md
  std::string text;
  bool worthless = false;  // results would be
};

/// Looks at the first pairs of a drive for what makes a stereo camera useless without a word: rows that do not agree,
/// images exchanged or taken at different times, distortion left in, exposure and times that jump, blur. Takes about
/// as long per pair as following it. Call in the order of the frames.
class InputCheck {
 public:
  static constexpr std::size_t kPairs = 20;
  /// With `half`, two of four pairs are looked at, for half the cost.
  explicit InputCheck(const StereoCamera& camera, bool half = false);

  /// Pairs that lack an image are passed over, and so are those after the first kPairs.
  void observe(const StereoFrame& pair);
  bool complete() const { return pairs_ >= kPairs; }

  /// Of the pairs so far.
  PairGeometry geometry() const { return estimatePairGeometry(matches_, camera_); }
  /// Of the pairs so far; empty where all is well.
  std::vector<Finding> findings() const;

 private:
  struct Pair {
    ImagePyramid left, right;
    std::vector<Corner> corners;
  };
  /// Pairs whose rows agree badly, and how many of them agree better with the right image before, or after.
  struct Apart {
    int bad = 0, before = 0, after = 0;
  };
  void lookAt(const StereoFrame& pair);
  void compareWithNeighbors(const Pair& now, std::size_t in_row, std::size_t matched);
  void observeLight(const StereoFrame& pair);
  std::optional<Finding> apart() const;
  std::optional<Finding> exchanged() const;
  void addRowErrors(std::vector<Finding>& findings) const;
  void addLight(std::vector<Finding>& findings) const;
  void addTimes(std::vector<Finding>& findings) const;

  StereoCamera camera_;
  bool half_;
  CornerDetector detect_corners_;
  ImagePool pool_;
  std::size_t pairs_ = 0;
  std::optional<Pair> before_;
  std::vector<EpipolarMatch> matches_;
  Apart apart_;
  std::vector<double> left_means_, right_means_, left_grains_, right_grains_;  // gray levels
  std::vector<Timestamp> stamps_;
};

}  // namespace motorcade
