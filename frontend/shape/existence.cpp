#include "frontend/shape/existence.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/elementary.hpp"

namespace motorcade {
namespace {

constexpr double kTrafficSpeed_mps = 10;  // standard deviation, along each axis
// Wrong matches on what repeats are as certain as right ones: a sure speed alone proves no more than this.
constexpr double kMostBySpeed = 2, kLeastBySpeed = -4;
constexpr double kMostPerSpeed = 0.5;  // per m/s: most wrong matches seem to move slowly
constexpr double kForgetting = 0.1;    // of the best recent speed, a frame
/// Log odds by which the best of all settled speeds promises too much: of eight tracks that came to less than this by
/// speed and verdicts, none was of a body.
constexpr double kBestOfMany = 0.55;
constexpr double kMostByVerdicts = 6;
constexpr double kDoubt = 2.2;          // log odds against a slow birth, until the image tells more
constexpr double kSure = 2.5;           // sum of verdicts from which on a body was surely seen: one clear verdict
constexpr double kSlip = 1.5;           // log odds against a track's slipping off its body: one in five does
constexpr std::size_t kMostSums = 100;  // that are kept: the oldest of them counts for all frames before it

/// Shares of a verdict among those that tracks get, counted once while it lasts: for tracks whose rows match labels
/// that move, and for tracks whose rows match none.
struct VerdictShare {
  double of_body, of_nothing;
};
/// Shares of each MotionVerdict, in its order.
constexpr std::array<VerdictShare, 9> kShares{{{0.5, 0.04},    // moved
                                               {0.2, 0.1},     // hardly
                                               {0.06, 0.07},   // mixed
                                               {0.03, 0.17},   // rested
                                               {0.01, 0.06},   // on the road
                                               {0.01, 0.07},   // within
                                               {0.002, 0.04},  // behind
                                               {0.0025, 0.1},  // repeats
                                               {0.17, 0.4}}};  // nothing

/// Most points of a track that is never put to the test: three points agree with some motion, whatever they do.
constexpr std::size_t kUntested = 3;
/// Shares of such tracks. Those of others are .98 and .66, which says little and is left out.
constexpr VerdictShare kUntestedShare{0.02, 0.34};

/// Frames in which images may tell, and speed, from and up to which it counts that no image ever told. A body that is
/// so slow and stays so long would be near enough.
constexpr int kFramesToTell = 6;
constexpr double kWalk_mps = 2;
/// Shares of tracks of which none told: none of 101 bodies, and 15 of 43 of nothing.
constexpr VerdictShare kNeverToldShare{0.01, 0.35};

double logRatio(const VerdictShare& share) { return logarithm(share.of_body / share.of_nothing); }

/// Log likelihood ratio of a speed among those of traffic against an error of something at rest: both are Gaussian.
double speedEvidence(double speed_mps, double sigma_mps) {
  const double misfit_at_rest = speed_mps / sigma_mps, spread = kTrafficSpeed_mps / sigma_mps;
  const double variance = 1 + spread * spread;  // of the misfit in traffic
  const double evidence = 0.5 * misfit_at_rest * misfit_at_rest * (1 - 1 / variance) - 0.5 * logarithm(variance);
  return std::clamp(evidence, kLeastBySpeed, std::min(kMostBySpeed, kMostPerSpeed * speed_mps));
}

/// Probability by the sum of verdicts, which takes them as independent although they are not. By labels, one in six
/// tracks is real however low the sum is below `kLeast`, and the odds are higher than the sum says above 0.
double probabilityOf(double log_odds) {
  constexpr double kLeast = -1.6, kPerLogOdds = 1.4;
  return 1 / (1 + exponential(log_odds > 0 ? -kPerLogOdds * log_odds : -std::max(log_odds, kLeast)));
}

}  // namespace

Existence::Existence() : recent_speed_(kLeastBySpeed), settled_speed_(kLeastBySpeed) {}

void Existence::doubtSlowBirth() { verdicts_ -= kDoubt; }

void Existence::addSpeed(double speed_mps, double sigma_mps) {
  recent_speed_ = std::max(recent_speed_ - kForgetting, speedEvidence(speed_mps, sigma_mps));
}

void Existence::addSettledSpeed(double speed_mps, double sigma_mps) {
  const double evidence = speedEvidence(speed_mps, sigma_mps);
  if (evidence > 0) {
    settled_speed_ = std::max(settled_speed_, evidence);
  } else if (settled_speed_ <= 0 && sigma_mps < surest_mps_) {
    settled_speed_ = evidence;
    surest_mps_ = sigma_mps;
  }
}

/// Adds a verdict. Successive frames show much the same: the n-th with one verdict counts as a part of 1 / n.
void Existence::addVerdict(FrameId frame, MotionVerdict verdict) {
  if (verdict == MotionVerdict::kUntold) {
    ++untold_;
    return;
  }
  told_ = true;
  repeated_ = verdict == last_ ? repeated_ + 1 : 1;
  last_ = verdict;
  const VerdictShare& share = kShares[static_cast<std::size_t>(verdict)];
  verdicts_ += logRatio(share) / repeated_;
  verdicts_ = std::clamp(verdicts_, -kMostByVerdicts, kMostByVerdicts);
  while (!largest_.empty() && largest_.back().verdicts <= verdicts_) largest_.pop_back();
  largest_.push_back({frame, verdicts_});
  if (largest_.size() > kMostSums) largest_.pop_front();
}

void Existence::addFollowed(std::size_t points) { most_followed_ = std::max(most_followed_.value_or(0), points); }

double Existence::followedEvidence() const {
  if (!most_followed_ || *most_followed_ > kUntested) return 0;
  return logRatio(kUntestedShare);
}

double Existence::untoldEvidence() const {
  const bool is_slow = std::max(recent_speed_, settled_speed_) < kMostPerSpeed * kWalk_mps;
  return is_slow && !told_ && untold_ >= kFramesToTell ? logRatio(kNeverToldShare) : 0;
}

double Existence::probability() const {
  return probabilityOf(std::max(recent_speed_, settled_speed_) + verdicts_ + followedEvidence() + untoldEvidence());
}

double Existence::settledProbability(FrameId frame) const {
  const auto later = std::ranges::lower_bound(largest_, frame, {}, &Sum::frame);
  const bool surely_seen = later != largest_.end() && later->verdicts >= kSure;
  const double before_slip = surely_seen ? later->verdicts - kSlip : verdicts_;
  const double by_speed = settled_speed_ > 0 ? settled_speed_ - kBestOfMany : settled_speed_;
  return probabilityOf(by_speed + std::max(verdicts_, before_slip) + followedEvidence() + untoldEvidence());
}

}  // namespace motorcade
