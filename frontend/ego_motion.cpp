#include "frontend/ego_motion.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <random>

namespace motorcade {
namespace {

/// Observations that vote on hypotheses, with the weight of their vote.
struct Voter {
  const PoseObservation* observation;
  double weight;
};

std::vector<Voter> chooseVoters(std::span<const PoseObservation> observations, const std::vector<bool>& moved_before,
                                const EgoMotionEstimator::Params& params) {
  std::vector<Voter> voters;
  const double stride = std::max(1.0, static_cast<double>(observations.size()) / params.scored_points);
  for (double at = 0; at < static_cast<double>(observations.size()); at += stride) {
    const auto i = static_cast<std::size_t>(at);
    voters.push_back({&observations[i], moved_before[i] ? params.known_mover_weight : 1.0});
  }
  return voters;
}

/// Truncated quadratic score (MSAC): the smaller the better.
double score(const StereoCamera& camera, const std::vector<Voter>& voters, const SE3& T_now_previous, double inlier_chi2) {
  double sum = 0;
  for (const auto& voter : voters) sum += voter.weight * std::min(inlier_chi2, poseChi2(camera, *voter.observation, T_now_previous));
  return sum;
}

double totalWeight(const std::vector<Voter>& voters) {
  double sum = 0;
  for (const auto& voter : voters) sum += voter.weight;
  return sum;
}

}  // namespace

SE3 EgoMotionEstimator::bestHypothesis(std::span<const PoseObservation> observations, const std::vector<bool>& moved_before,
                                       const SE3& predicted_T_now_previous, std::uint64_t seed) const {
  const auto voters = chooseVoters(observations, moved_before, params_);
  PoseFitParams minimal = params_.fit;
  minimal.max_iterations = 5;
  std::vector<std::size_t> candidates;
  for (std::size_t i = 0; i < observations.size(); ++i)
    if (!moved_before[i]) candidates.push_back(i);

  SE3 best = predicted_T_now_previous;
  double best_score = score(camera_, voters, best, params_.inlier_chi2);
  const double worst_score = params_.inlier_chi2 * totalWeight(voters);
  if (candidates.size() < 3) return best;
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<std::size_t> pick(0, candidates.size() - 1);
  for (int k = 0; k < params_.max_hypotheses; ++k) {
    std::array<PoseObservation, 3> sample{observations[candidates[pick(random)]], observations[candidates[pick(random)]],
                                          observations[candidates[pick(random)]]};
    const auto fit = fitPose(camera_, sample, predicted_T_now_previous, minimal);
    if (!fit) continue;
    const double fit_score = score(camera_, voters, fit->T_cam_a, params_.inlier_chi2);
    if (fit_score >= best_score) continue;
    best_score = fit_score;
    best = fit->T_cam_a;
    if (best_score < 0.25 * worst_score && k >= params_.max_hypotheses / 4) break;  // three quarters agree: more samples gain nothing
  }
  return best;
}

std::optional<EgoMotion> EgoMotionEstimator::operator()(std::span<const PoseObservation> observations,
                                                        const std::vector<bool>& moved_before, const SE3& predicted_T_previous_now,
                                                        std::uint64_t seed) const {
  assert(observations.size() == moved_before.size());
  if (static_cast<int>(observations.size()) < params_.min_inliers) return std::nullopt;
  const SE3 start = bestHypothesis(observations, moved_before, predicted_T_previous_now.inverse(), seed);

  std::vector<PoseObservation> agreeing;
  for (const auto& o : observations)
    if (poseChi2(camera_, o, start) < 3 * params_.inlier_chi2) agreeing.push_back(o);
  const auto fit = fitPose(camera_, agreeing, start, params_.fit);
  if (!fit) return std::nullopt;

  EgoMotion ego;
  ego.T_previous_now = fit->T_cam_a.inverse();
  // log((T exp(xi))^-1) moves the perturbation to the other side: the covariance follows by the adjoint of T_now_previous.
  const Matrix6d A = fit->T_cam_a.adjoint();
  ego.covariance = std::max(1.0, fit->inlier_chi2_per_dof) * A * fit->covariance * A.transpose();
  ego.inliers.reserve(observations.size());
  for (const auto& o : observations) ego.inliers.push_back(poseChi2(camera_, o, fit->T_cam_a) < params_.inlier_chi2);
  ego.inlier_count = static_cast<int>(std::count(ego.inliers.begin(), ego.inliers.end(), true));
  if (ego.inlier_count < params_.min_inliers) return std::nullopt;
  return ego;
}

}  // namespace motorcade
