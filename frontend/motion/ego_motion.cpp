#include "frontend/motion/ego_motion.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <random>
#include <utility>

namespace motorcade {
namespace {

constexpr int kScoredPoints = 300;                          // of all observations: more tell hypotheses apart no better
constexpr int kMinimalIterations = 5;                       // of a fit to three points, which starts near
constexpr double kMinimalStep = 1e-4, kRefinedStep = 1e-5;  // m and rad, after which fits end
constexpr double kKnownMoverWeight = 0.1;  // vote of a point that moved in the frame before: it may have stopped
constexpr double kRoadShare = 0.2;         // of the votes
constexpr double kRoadDepth_m = 15;        // farther away, a vehicle's lower edge may pass for the road
constexpr int kRoadPoints = 10;            // with fewer it may be no road
constexpr double kVoteCell_m = 4;          // edge of the floor's cells, each with one vote: about a car's length
constexpr double kVoteDepth_m = 40;        // beyond it depth noise exceeds a cell
constexpr double kSurprisePenalty = 0.3;   // votes, as a share of all, against a motion that no vehicle can make
constexpr double kMaxSurprise = 2;         // times this penalty: all points may jump, where an unseen frame is missing
constexpr double kSensorsPenalty = 0.8;    // the same against what the vehicle's own sensors contradict
constexpr double kSensorsSigmas = 4;       // of their motion, beyond which they do
constexpr int kTrustedSteadyFrames = 3;    // after which the penalty counts in full
constexpr int kTrustedAheadFrames = 20;    // after which a camera that slides is not believed
constexpr double kSlide_mps = 0.5, kSlideShare = 0.2;   // sideways and upwards; the latter of the way ahead
constexpr double kSway_radps = 0.15, kMinRadius_m = 3;  // turning where it stands, and the tightest curve
constexpr double kYawRate_radps = 1.0;                  // of a tight curve
constexpr double kDriving_mps = 3.0;                    // faster than what is carried or flies indoors
constexpr double kClearScore = 0.25;  // of the worst score: three quarters agree, and more samples gain nothing ...
constexpr int kSearchShare = 4;       // ... once a quarter of the hypotheses have been tried
/// Share of the points that may agree with a wrong motion. Where two vehicles fill the view, the points of each agree
/// with it along a band of the image: a tolerance of 3 px of flows that differ by 60 px and more. A motion on which no
/// more agree must be steadier than others, by half the acceleration.
constexpr double kByChance = 0.1, kSteadierThan = 0.5;
constexpr double kRefinementGate = 3;  // of the inliers' chi-square: a hypothesis of three points is not exact

/// The observations that vote on hypotheses, with the weights of their votes.
struct Voters {
  PoseObservations observations;
  std::vector<double> weights;
  double worst_score;  // of a hypothesis that no observation agrees with
};

/// Chooses voters spread evenly over the observations.
Voters chooseVoters(std::span<const PoseObservation> observations, const std::vector<double>& votes,
                    double inlier_chi2) {
  std::vector<PoseObservation> voting;
  std::vector<double> weights;
  const double stride = std::max(1.0, static_cast<double>(observations.size()) / kScoredPoints);
  for (double at = 0; at < static_cast<double>(observations.size()); at += stride) {
    voting.push_back(observations[static_cast<std::size_t>(at)]);
    weights.push_back(votes[static_cast<std::size_t>(at)]);
  }
  const double worst_score = inlier_chi2 * std::accumulate(weights.begin(), weights.end(), 0.0);
  return {PoseObservations(voting), std::move(weights), worst_score};
}

/// Gives the road a share of the votes where enough of it is seen, while no steady motion is known: whatever moves, the
/// road does not.
void hearTheRoad(std::span<const PoseObservation> observations, const std::vector<PointLabel>& labels,
                 std::vector<double>& votes) {
  const auto isRoad = [&](std::size_t i) {
    return labels[i] == PointLabel::kGround && observations[i].p_ref.z() < kRoadDepth_m;
  };
  double road = 0, other = 0;
  int points = 0;
  for (std::size_t i = 0; i < votes.size(); ++i) {
    (isRoad(i) ? road : other) += votes[i];
    points += isRoad(i);
  }
  const double factor = kRoadShare / (1 - kRoadShare) * other / road;
  if (points < kRoadPoints || factor <= 1) return;
  for (std::size_t i = 0; i < votes.size(); ++i)
    if (isRoad(i)) votes[i] *= factor;
}

/// Vote of each observation. The world is larger than the vehicles in it, though these may carry most points, so the
/// floor space that agrees counts. Points share the vote of their cell; those beyond `kVoteDepth_m` share by bearing.
std::vector<double> votesOf(std::span<const PoseObservation> observations, const std::vector<PointLabel>& labels) {
  std::map<std::pair<int, int>, int> points_in;
  std::vector<int*> sharing;
  sharing.reserve(observations.size());
  for (const auto& o : observations) {
    const double scale = std::min(1.0, kVoteDepth_m / o.p_ref.z()) / kVoteCell_m;
    int& points = points_in[{static_cast<int>(std::floor(scale * o.p_ref.x())),
                             static_cast<int>(std::floor(scale * o.p_ref.z()))}];
    ++points;
    sharing.push_back(&points);
  }
  std::vector<double> votes;
  votes.reserve(observations.size());
  for (std::size_t i = 0; i < observations.size(); ++i)
    votes.push_back((labels[i] == PointLabel::kMoving ? kKnownMoverWeight : 1.0) / *sharing[i]);
  return votes;
}

/// Draws observations at random, each as often as its vote counts; known movers never.
class Sampler {
 public:
  Sampler(std::span<const PoseObservation> observations, const std::vector<double>& votes,
          const std::vector<PointLabel>& labels, std::uint64_t seed)
      : observations_(observations), votes_up_to_(observations.size()), random_(seed) {
    double total = 0;
    for (std::size_t i = 0; i < observations.size(); ++i)
      votes_up_to_[i] = total += labels[i] == PointLabel::kMoving ? 0.0 : votes[i];
    empty_ = total <= 0;
    up_to_ = std::uniform_real_distribution<double>(0, total);
  }
  bool empty() const { return empty_; }
  const PoseObservation& operator()() {
    const auto at = std::ranges::upper_bound(votes_up_to_, up_to_(random_));
    return observations_[std::min(static_cast<std::size_t>(at - votes_up_to_.begin()), observations_.size() - 1)];
  }

 private:
  std::span<const PoseObservation> observations_;
  std::vector<double> votes_up_to_;
  std::mt19937_64 random_;
  std::uniform_real_distribution<double> up_to_;
  bool empty_ = true;
};

}  // namespace

SE3 inAxes(const Eigen::Matrix3d& R_cam_axes, const SE3& T_seen_now) {
  const Eigen::Matrix3d R_axes_cam = R_cam_axes.transpose();
  return {R_axes_cam * T_seen_now.rotation() * R_cam_axes, R_axes_cam * T_seen_now.translation()};
}

bool drivesAhead(const SE3& T_seen_now, double dt_s) {
  return T_seen_now.translation().z() > kDriving_mps * dt_s && !slides(T_seen_now, dt_s);
}

bool slides(const SE3& T_seen_now, double dt_s) {
  const Eigen::Vector3d& way = T_seen_now.translation();
  const double chord = 0.5 * kYawRate_radps * dt_s;  // of a curve: its angle to the axis
  const double turn = T_seen_now.log().tail<3>().norm();
  return way.head<2>().norm() > kSlide_mps * dt_s + (kSlideShare + chord) * std::abs(way.z()) ||
         turn > kSway_radps * dt_s + std::abs(way.z()) / kMinRadius_m;
}

/// Penalty of a motion that surprises, as a share of all votes.
double EgoMotionEstimator::penaltyOf(const PredictedMotion& predicted) {
  if (predicted.by_vehicle) return kSensorsPenalty;
  return kSurprisePenalty * std::min(1.0, static_cast<double>(predicted.steady_frames) / kTrustedSteadyFrames);
}

bool EgoMotionEstimator::isBeyondBelief(const SE3& T_now_seen, const PredictedMotion& predicted) {
  return predicted.ahead_frames >= kTrustedAheadFrames &&
         slides(inAxes(predicted.R_cam_level, T_now_seen.inverse()), predicted.dt_s);
}

/// Ratio of the change from the prediction to what a vehicle can do, or to the error of its sensors; 1 is just
/// possible.
double EgoMotionEstimator::surprise(const SE3& T_now_seen, const PredictedMotion& predicted) const {
  const double change_m = (T_now_seen.inverse().translation() - predicted.T_seen_now.translation()).norm();
  const double possible_m = predicted.by_vehicle
                                ? kSensorsSigmas * std::sqrt(predicted.by_vehicle->topLeftCorner<3, 3>().trace())
                                : params_.max_acceleration_mps2 * predicted.dt_s * predicted.dt_s;
  return possible_m > 0 ? change_m / possible_m : std::numeric_limits<double>::infinity();
}

bool EgoMotionEstimator::breaks(const SE3& T_now_seen, const PredictedMotion& predicted) const {
  return (predicted.by_vehicle || predicted.steady_frames >= kTrustedSteadyFrames) && !follows(T_now_seen, predicted);
}

SE3 EgoMotionEstimator::bestHypothesis(std::span<const PoseObservation> observations,
                                       const std::vector<PointLabel>& labels, const PredictedMotion& predicted,
                                       std::uint64_t seed) const {
  auto votes = votesOf(observations, labels);
  if (predicted.steady_frames < kTrustedSteadyFrames) hearTheRoad(observations, labels, votes);
  const Voters voters = chooseVoters(observations, votes, params_.inlier_chi2);
  SE3 start = predicted.T_seen_now.inverse();
  Sampler sample(observations, votes, labels, seed);
  if (sample.empty()) return start;
  const double penalty = penaltyOf(predicted) * voters.worst_score;

  SE3 best = start;
  const auto score = [&](const SE3& T_now_seen, double bound) {
    return poseScore(camera_, voters.observations, T_now_seen, {voters.weights, params_.inlier_chi2}, bound);
  };
  double best_score = score(best, std::numeric_limits<double>::infinity());
  for (int k = 0; k < params_.max_hypotheses; ++k) {
    if (best_score < kClearScore * voters.worst_score && k >= params_.max_hypotheses / kSearchShare) break;
    const std::array<PoseObservation, 3> three{sample(), sample(), sample()};
    const auto fit = fitPose(camera_, PoseObservations(three), start,
                             {.max_iterations = kMinimalIterations, .min_step = kMinimalStep});
    if (!fit || isBeyondBelief(fit->T_cam_ref, predicted)) continue;
    double fit_score = score(fit->T_cam_ref, best_score);
    if (const double by = surprise(fit->T_cam_ref, predicted); by >= 1)
      fit_score += std::min(by, predicted.by_vehicle ? 1.0 : kMaxSurprise) * penalty;
    if (fit_score >= best_score) continue;
    best_score = fit_score;
    best = fit->T_cam_ref;
  }
  return best;
}

/// Refines a hypothesis over the points that agree with it, weighted by covariances.
std::optional<PoseFit> EgoMotionEstimator::refine(std::span<const PoseObservation> observations,
                                                  const PoseObservations& all, const SE3& hypothesis) const {
  const auto chi2 = poseChi2(camera_, all, hypothesis);
  std::vector<PoseObservation> agreeing;
  agreeing.reserve(observations.size());
  for (std::size_t i = 0; i < observations.size(); ++i)
    if (chi2[i] < kRefinementGate * params_.inlier_chi2) agreeing.push_back(observations[i]);
  return fitPose(camera_, PoseObservations(agreeing), hypothesis, {.min_step = kRefinedStep});
}

std::optional<EgoMotion> EgoMotionEstimator::operator()(std::span<const PoseObservation> observations,
                                                        const std::vector<PointLabel>& labels,
                                                        const PredictedMotion& predicted, std::uint64_t seed) const {
  assert(observations.size() == labels.size());
  if (static_cast<int>(observations.size()) < params_.min_inliers) return std::nullopt;
  const SE3 hypothesis = bestHypothesis(observations, labels, predicted, seed);
  const PoseObservations all(observations);
  const auto fit = refine(observations, all, hypothesis);
  if (!fit || isBeyondBelief(fit->T_cam_ref, predicted)) return std::nullopt;
  if (predicted.by_vehicle && !follows(fit->T_cam_ref, predicted)) return std::nullopt;

  EgoMotion ego;
  ego.T_seen_now = fit->T_cam_ref.inverse();
  // log((T exp(xi))^-1) moves the perturbation to the other side: the covariance follows by the adjoint of
  // T_now_seen.
  const Matrix6d A = fit->T_cam_ref.adjoint();
  ego.covariance = std::max(1.0, fit->inlier_chi2_per_dof) * A * fit->covariance * A.transpose();
  ego.inliers.reserve(observations.size());
  for (const double chi2 : poseChi2(camera_, all, fit->T_cam_ref)) ego.inliers.push_back(chi2 < params_.inlier_chi2);
  ego.inlier_count = static_cast<int>(std::count(ego.inliers.begin(), ego.inliers.end(), true));
  if (ego.inlier_count < params_.min_inliers) return std::nullopt;
  const bool by_chance = ego.inlier_count < kByChance * static_cast<double>(observations.size());
  const bool is_steady = surprise(fit->T_cam_ref, predicted) < kSteadierThan;
  const bool was_steady = predicted.steady_frames >= kTrustedSteadyFrames || predicted.stood;
  const bool is_known = was_steady && !predicted.by_vehicle;
  if (by_chance && is_known && !is_steady) return std::nullopt;
  return ego;
}

std::vector<Parameter> parametersOf(EgoMotionEstimator::Params& params) {
  return {numberParameter("max_hypotheses", params.max_hypotheses, {10, 10000},
                          "more find the motion among more outliers, at more cost"),
          numberParameter("inlier_chi2", params.inlier_chi2, {4, 100}, "higher tolerates a worse calibration"),
          numberParameter("min_inliers", params.min_inliers, {6, 100},
                          "lower goes on in scenes with little texture, higher reports the frame as lost"),
          numberParameter("max_acceleration_mps2", params.max_acceleration_mps2, {1, 1000},
                          "what the vehicle can do: a motion beyond it must win by more")};
}

}  // namespace motorcade
