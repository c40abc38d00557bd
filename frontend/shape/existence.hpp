#pragma once

#include <cstddef>
#include <deque>
#include <limits>
#include <optional>

#include "core/messages.hpp"

namespace motorcade {

/// Verdict of one frame's image around an object's followed points.
enum class MotionVerdict {
  kMoved,    // nearly all of it moved with the body
  kHardly,   // the same of a point or two, which may well be wrong
  kMixed,    // some of it did, some rested
  kRested,   // nearly all of it rested
  kOnRoad,   // nearly all of its points lie on the road, as a shadow or what a wet road mirrors does
  kWithin,   // nearly all of its points lie within an object that was known before
  kBehind,   // what rests around it in the image is nearer, as the surface is in which something is mirrored
  kRepeats,  // the texture around it repeats, so that points at rest may seem to move
  kNothing,  // no point of the object has a surface around it that tells, although motion and rest are well apart
  kUntold    // motion and rest cannot be told apart
};

/// Probability that a track is a body that moves or once moved, by the odds of that against something at rest which was
/// measured wrongly. Before anything is seen of it, a track is as likely the one as the other.
class Existence {
 public:
  Existence();
  /// Call first for a track that was as slow and small as a person when it was spawned: most of these are nothing.
  void doubtSlowBirth();
  /// Adds an online estimate of the speed; `sigma_mps` holds the errors that all points share. Estimates are not added
  /// up, as each gathers what was seen before it. An object that stops counts as one that moved for some time yet.
  void addSpeed(double speed_mps, double sigma_mps);
  /// Adds a settled or final estimate: what moved then has moved for good. Of estimates of rest the surest counts.
  void addSettledSpeed(double speed_mps, double sigma_mps);
  /// Call in frame order.
  void addVerdict(FrameId frame, MotionVerdict verdict);

  /// Adds the number of points and patches by which it was followed in a frame.
  void addFollowed(std::size_t points);

  /// Returns the probability by all that was seen up to now.
  double probability() const;
  /// Returns the probability that it was there in a frame, by the verdicts of all frames. It takes the settled motion
  /// alone, as online estimates may have been wrong. A body that is surely seen in a later frame was there before, even
  /// if the track has slipped off it since.
  double settledProbability(FrameId frame) const;

 private:
  double followedEvidence() const;
  double untoldEvidence() const;

  double recent_speed_, settled_speed_;                          // log likelihood ratios
  double surest_mps_ = std::numeric_limits<double>::infinity();  // standard deviation of a speed that is none
  /// The sum of verdicts up to a frame. It is kept while no later one is larger.
  struct Sum {
    FrameId frame;
    double verdicts;
  };
  double verdicts_ = 0;
  std::optional<std::size_t> most_followed_;  // of all frames
  std::deque<Sum> largest_;                   // oldest first, and so the largest
  MotionVerdict last_ = MotionVerdict::kUntold;
  int repeated_ = 0, untold_ = 0;  // frames with the last verdict, and without any
  bool told_ = false;              // by some image
};

}  // namespace motorcade
