#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
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

/// How bright the images of the pairs so far are, and how much they differ.
struct LightMeasures {
  double left_level = 0, right_level = 0;  // gray levels, means
  double jump = 1;                         // largest ratio from one pair to the next, of the left images
  double sides = 1;                        // largest ratio of the two images of a pair
  double left_grain = 0, right_grain = 0;  // gray levels, medians; 0 where it cannot be told
};

/// Seconds between the pairs so far; all 0 while there are fewer than two.
struct TimeMeasures {
  double usual_s = 0, least_s = 0, most_s = 0;
};

/// The matches of one of the pairs that were looked at.
struct LookedAt {
  FrameId frame;
  std::span<const EpipolarMatch> matches;
};

/// Looks at the first pairs of a drive for what makes a stereo camera useless without a word: rows that do not agree,
/// images exchanged or taken at different times, distortion left in, exposure and times that jump, blur. Takes about
/// as long per pair as following it. Call in the order of the frames.
class InputCheck {
 public:
  static constexpr std::size_t kPairs = 20;
  static constexpr std::size_t kFewestMatches = 60;  // that a rig is judged by
  /// With `half`, two of four pairs are looked at, for half the cost.
  explicit InputCheck(const StereoCamera& camera, bool half = false);

  /// Pairs that lack an image are passed over, and so are those after the first kPairs.
  void observe(const StereoFrame& pair);
  bool complete() const { return pairs_ >= kPairs; }

  /// Of the pairs so far.
  PairGeometry geometry() const { return estimatePairGeometry(matches_, camera_); }
  std::size_t pairs() const { return pairs_; }
  std::span<const EpipolarMatch> matches() const { return matches_; }
  /// As long as no other pair is observed.
  std::vector<LookedAt> looks() const;
  LightMeasures light() const;
  TimeMeasures times() const;
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
  std::vector<std::pair<FrameId, std::size_t>> looks_;  // with the number of matches so far
  Apart apart_;
  std::vector<double> left_means_, right_means_, left_grains_, right_grains_;  // gray levels
  std::vector<Timestamp> stamps_;
};

}  // namespace motorcade
