#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "apps/watch/pair_geometry.hpp"
#include "core/messages.hpp"

namespace motorcade {

/// A fault of the pairs of a rig, in a sentence that says what was measured, what it means and how to mend it.
struct Finding {
  std::string name;  // one word, as in docs/formats.md
  std::string text;
  bool worthless = false;  // results would be
};

/// Brightness of the images of the pairs so far, and its differences.
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

/// Checks pairs of a drive for faults that silently make a stereo camera useless: rows that do not agree, images
/// exchanged or taken at different times, distortion left in, exposure and times that jump, blur. Takes about a third
/// as long per pair as following it. Call in the order of the frames.
class InputCheck {
 public:
  static constexpr std::size_t kPairs = 20;
  static constexpr std::size_t kFewestMatches = 60;  // that a rig is judged by
  /// Judges by so many pairs.
  explicit InputCheck(const StereoCamera& camera, std::size_t pairs = kPairs) : camera_(camera), wanted_(pairs) {}

  /// Looks at a pair, unless enough were seen. Passes over pairs that lack an image, show hardly a point that both eyes
  /// see, or come after their turn.
  void observe(const StereoFrame& pair);
  bool complete() const { return pairs_ >= wanted_; }

  /// Geometry of the pairs so far.
  PairGeometry geometry() const { return estimatePairGeometry(matches_, camera_); }
  std::size_t pairs() const { return pairs_; }
  std::span<const EpipolarMatch> matches() const { return matches_; }
  /// Matches by pair, valid until another pair is observed.
  std::vector<LookedAt> looks() const;
  LightMeasures light() const;
  TimeMeasures times() const;
  /// Findings on the pairs so far; empty where all is well.
  std::vector<Finding> findings() const;
  /// The findings on the cameras' positions, order and capture times.
  std::vector<Finding> rigFindings() const;

 private:
  /// Counts the pairs compared with the previous pair and, among them, those whose rows agree badly. The last two
  /// count the bad pairs where a left image fits the right image before or after its own better.
  struct Apart {
    std::size_t compared = 0, bad = 0, before = 0, after = 0;
  };
  void compareWithNeighbors(const PreparedPair& now, std::span<const EpipolarMatch> matches);
  void observeLight(const StereoFrame& pair);
  std::optional<Finding> apart() const;
  std::optional<Finding> incoherent(const PairGeometry& geometry) const;
  std::optional<Finding> exchanged() const;
  static void addRowErrors(const PairGeometry& geometry, std::vector<Finding>& findings);
  void addLight(std::vector<Finding>& findings) const;
  void addTimes(std::vector<Finding>& findings) const;
  void addPoints(std::vector<Finding>& findings) const;

  StereoCamera camera_;
  std::size_t wanted_;
  ImagePool pool_;
  std::size_t pairs_ = 0, passed_over_ = 0;
  FrameId last_;
  std::optional<PreparedPair> before_;
  std::vector<EpipolarMatch> matches_;
  std::vector<std::pair<FrameId, std::size_t>> looks_;  // with the number of matches so far
  Apart apart_;
  std::vector<double> left_means_, right_means_, left_grains_, right_grains_;  // gray levels
  std::vector<Timestamp> stamps_;
};

/// True if both images exist.
inline bool isWhole(const StereoFrame& pair) { return !pair.rejected() && !pair.left.empty() && !pair.right.empty(); }

/// True if clearly more of the points lie behind the cameras than before them: left and right are exchanged.
bool looksExchanged(std::span<const EpipolarMatch> matches);

}  // namespace motorcade
