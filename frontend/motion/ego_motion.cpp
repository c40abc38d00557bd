#include "frontend/motion/ego_motion.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <map>
#include <numeric>
#include <random>
#include <utility>

namespace motorcade {
namespace {

/// The observations that vote on hypotheses, with the weights of their votes.
struct Voters {
  PoseObservations observations;
  std::vector<double> weights;
};

/// Truncated quadratic score (MSAC): the smaller the better.
double score(const StereoCamera& camera, const Voters& voters, const SE3& T_now_previous, double inlier_chi2) {
  const auto chi2 = poseChi2(camera, voters.observations, T_now_previous);
  double sum = 0;
  for (std::size_t i = 0; i < chi2.size(); ++i) sum += voters.weights[i] * std::min(inlier_chi2, chi2[i]);
  return sum;
}

}  // namespace

/// Of each observation. The world is larger than the vehicles in it, though these may carry most points: so what counts
/// is the floor space that agrees. Points share the vote of their cell; those beyond `vote_depth_m` share by bearing.
std::vector<double> EgoMotionEstimator::votes(std::span<const PoseObservation> observations,
                                              const std::vector<bool>& known_movers) const {
  std::map<std::pair<int, int>, int> points_in;
  std::vector<int*> sharing;
  sharing.reserve(observations.size());
  for (const auto& o : observations) {
    const double scale = std::min(1.0, params_.vote_depth_m / o.p_ref.z()) / params_.vote_cell_m;
    int& points = points_in[{static_cast<int>(std::floor(scale * o.p_ref.x())),
                             static_cast<int>(std::floor(scale * o.p_ref.z()))}];
    ++points;
    sharing.push_back(&points);
  }
  std::vector<double> votes;
  votes.reserve(observations.size());
  for (std::size_t i = 0; i < observations.size(); ++i)
    votes.push_back((known_movers[i] ? params_.known_mover_weight : 1.0) / *sharing[i]);
  return votes;
}

bool EgoMotionEstimator::follows(const SE3& T_now_previous, const PredictedMotion& predicted) const {
  const double change_m = (T_now_previous.inverse().translation() - predicted.T_previous_now.translation()).norm();
  return change_m < params_.max_acceleration_mps2 * predicted.dt_s * predicted.dt_s;
}

SE3 EgoMotionEstimator::bestHypothesis(std::span<const PoseObservation> observations,
                                       const std::vector<bool>& known_movers, const PredictedMotion& predicted,
                                       std::uint64_t seed) const {
  const auto vote = votes(observations, known_movers);
  std::vector<PoseObservation> voting;
  std::vector<double> weights;
  const double stride = std::max(1.0, static_cast<double>(observations.size()) / params_.scored_points);
  for (double at = 0; at < static_cast<double>(observations.size()); at += stride) {
    voting.push_back(observations[static_cast<std::size_t>(at)]);
    weights.push_back(vote[static_cast<std::size_t>(at)]);
  }
  const double worst_score = params_.inlier_chi2 * std::accumulate(weights.begin(), weights.end(), 0.0);
  const Voters voters{PoseObservations(voting), std::move(weights)};
  std::vector<double> votes_up_to(observations.size());
  double total = 0;
  for (std::size_t i = 0; i < observations.size(); ++i) votes_up_to[i] = total += known_movers[i] ? 0.0 : vote[i];
  PoseFitParams minimal = params_.fit;
  minimal.max_iterations = 5;

  SE3 best = predicted.T_previous_now.inverse();
  const SE3 start = best;
  double best_score = score(camera_, voters, best, params_.inlier_chi2);
  const double trust = std::min(1.0, static_cast<double>(predicted.steady_frames) / params_.trusted_steady_frames);
  const double penalty = params_.surprise_penalty * trust * worst_score;
  if (total <= 0) return best;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> upTo(0, total);
  const auto pick = [&] {
    const auto at = std::ranges::upper_bound(votes_up_to, upTo(random));
    return observations[std::min(static_cast<std::size_t>(at - votes_up_to.begin()), observations.size() - 1)];
  };
  for (int k = 0; k < params_.max_hypotheses; ++k) {
    if (best_score < 0.25 * worst_score && k >= params_.max_hypotheses / 4)
      break;  // three quarters agree: more samples gain nothing
    const std::array<PoseObservation, 3> sample{pick(), pick(), pick()};
    const auto fit = fitPose(camera_, PoseObservations(sample), start, minimal);
    if (!fit) continue;
    double fit_score = score(camera_, voters, fit->T_cam_ref, params_.inlier_chi2);
    if (!follows(fit->T_cam_ref, predicted)) fit_score += penalty;
    if (fit_score >= best_score) continue;
    best_score = fit_score;
    best = fit->T_cam_ref;
  }
  return best;
}

std::optional<EgoMotion> EgoMotionEstimator::operator()(std::span<const PoseObservation> observations,
                                                        const std::vector<bool>& known_movers,
                                                        const PredictedMotion& predicted, std::uint64_t seed) const {
  assert(observations.size() == known_movers.size());
  if (static_cast<int>(observations.size()) < params_.min_inliers) return std::nullopt;
  const SE3 start = bestHypothesis(observations, known_movers, predicted, seed);

  const PoseObservations all(observations);
  const auto start_chi2 = poseChi2(camera_, all, start);
  std::vector<PoseObservation> agreeing;
  agreeing.reserve(observations.size());
  for (std::size_t i = 0; i < observations.size(); ++i)
    if (start_chi2[i] < 3 * params_.inlier_chi2) agreeing.push_back(observations[i]);
  const auto fit = fitPose(camera_, PoseObservations(agreeing), start, params_.fit);
  if (!fit) return std::nullopt;

  EgoMotion ego;
  ego.T_previous_now = fit->T_cam_ref.inverse();
  // log((T exp(xi))^-1) moves the perturbation to the other side: the covariance follows by the adjoint of
  // T_now_previous.
  const Matrix6d A = fit->T_cam_ref.adjoint();
  ego.covariance = std::max(1.0, fit->inlier_chi2_per_dof) * A * fit->covariance * A.transpose();
  ego.inliers.reserve(observations.size());
  for (const double chi2 : poseChi2(camera_, all, fit->T_cam_ref)) ego.inliers.push_back(chi2 < params_.inlier_chi2);
  ego.inlier_count = static_cast<int>(std::count(ego.inliers.begin(), ego.inliers.end(), true));
  if (ego.inlier_count < params_.min_inliers) return std::nullopt;
  ego.steady = follows(fit->T_cam_ref, predicted);
  return ego;
}

std::vector<Parameter> parametersOf(EgoMotionEstimator::Params& params) {
  return {numberParameter("max_hypotheses", params.max_hypotheses, {10, 10000},
                          "more find the motion among more outliers, at more cost"),
          numberParameter("inlier_chi2", params.inlier_chi2, {4, 100}, "higher tolerates a worse calibration"),
          numberParameter("min_inliers", params.min_inliers, {6, 200},
                          "lower goes on in scenes with little texture, higher reports the frame as lost"),
          numberParameter("max_acceleration_mps2", params.max_acceleration_mps2, {1, 1000},
                          "what the vehicle can do: a motion beyond it must win by more")};
}

}  // namespace motorcade
