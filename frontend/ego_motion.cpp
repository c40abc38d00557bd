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

double EgoMotionEstimator::weightOf(EgoHint hint) const {
  if (hint == EgoHint::kMoved) return params_.known_mover_weight;
  return hint == EgoHint::kGround ? params_.ground_weight : 1.0;
}

SE3 EgoMotionEstimator::bestHypothesis(std::span<const PoseObservation> observations, std::span<const EgoHint> hints,
                                       const SE3& predicted_T_now_previous, std::uint64_t seed) const {
  std::vector<Voter> voters;
  const double stride = std::max(1.0, static_cast<double>(observations.size()) / params_.scored_points);
  for (double at = 0; at < static_cast<double>(observations.size()); at += stride)
    voters.push_back({&observations[static_cast<std::size_t>(at)], weightOf(hints[static_cast<std::size_t>(at)])});
  std::vector<std::size_t> candidates, ground;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    if (hints[i] != EgoHint::kMoved) candidates.push_back(i);
    if (hints[i] == EgoHint::kGround) ground.push_back(i);
  }
  PoseFitParams minimal = params_.fit;
  minimal.max_iterations = 5;

  SE3 best = predicted_T_now_previous;
  double best_score = score(camera_, voters, best, params_.inlier_chi2);
  const double worst_score = params_.inlier_chi2 * totalWeight(voters);
  if (candidates.size() < 3) return best;
  std::mt19937_64 random(seed);
  constexpr std::size_t kEnoughGround = 20;  // to draw every other sample from the road alone
  for (int k = 0; k < params_.max_hypotheses; ++k) {
    const auto& from = k % 2 == 1 && ground.size() >= kEnoughGround ? ground : candidates;
    std::uniform_int_distribution<std::size_t> pick(0, from.size() - 1);
    std::array<PoseObservation, 3> sample{observations[from[pick(random)]], observations[from[pick(random)]],
                                          observations[from[pick(random)]]};
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

std::optional<EgoMotion> EgoMotionEstimator::operator()(std::span<const PoseObservation> observations, std::span<const EgoHint> hints,
                                                        const SE3& predicted_T_previous_now, std::uint64_t seed) const {
  assert(observations.size() == hints.size());
  if (static_cast<int>(observations.size()) < params_.min_inliers) return std::nullopt;
  const SE3 start = bestHypothesis(observations, hints, predicted_T_previous_now.inverse(), seed);

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
