#include "frontend/shape/box_belief.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

#include "core/decompositions.hpp"
#include "core/elementary.hpp"
#include "frontend/shape/kind_belief.hpp"

namespace motorcade {
namespace {

/// Usual size of a kind, and how usual it is.
struct SizedKind {
  ObjectKind kind;
  UsualSize size;
  double share;
  double top_speed_mps;
};

/// Kinds and sizes. Vans are cars here, with a line of their own, as they are a size of their own. Vehicles vary less
/// than in `kKindsOfStreets` of the reported belief: the search for outlines needs sharp volumes.
const std::array<SizedKind, 5> kKinds{{{ObjectKind::kCar, {{4.1, 1.72, 1.55}, {0.5, 0.15, 0.15}}, 0.7, 60},
                                       {ObjectKind::kCar, {{5.2, 2.0, 2.15}, {0.6, 0.2, 0.25}}, 0.12, 60},
                                       {ObjectKind::kLargeVehicle, {{10.0, 2.55, 3.2}, {2.5, 0.15, 0.4}}, 0.06, 40},
                                       {ObjectKind::kTwoWheeler, {{1.76, 0.6, 1.74}, {0.25, 0.12, 0.15}}, 0.03, 15},
                                       {ObjectKind::kPedestrian, {{0.84, 0.66, 1.76}, {0.25, 0.15, 0.13}}, 0.06, 3}}};

constexpr double kRuledOut = 1e-3;       // of the likeliest kind's likelihood
constexpr double kSpeedSlack_mps = 0.7;  // by which a kind is faster than usual with one standard deviation
constexpr double kAheadSigma_m = 2;      // of the origin from the middle, along the body

const std::array<FacePrior, kKinds.size()> kPriors = [] {
  std::array<FacePrior, kKinds.size()> priors;
  for (std::size_t i = 0; i < kKinds.size(); ++i) priors[i] = facePrior(kKinds[i].size, kAheadSigma_m);
  return priors;
}();

struct Posterior {
  BoxEstimate estimate;
  double log_evidence = 0;
};

Posterior posteriorOf(const SizedKind& kind, const FacePrior& prior, const FaceInformation& evidence,
                      const BodyTraits& traits) {
  const FacePosterior of_faces = posteriorFaces(prior.faces, evidence);
  Posterior posterior;
  posterior.estimate.faces = of_faces.faces;
  posterior.estimate.covariance = of_faces.covariance;
  posterior.estimate.kind = kind.kind;
  const double too_fast = std::max(0.0, traits.speed_mps - kind.top_speed_mps) / kSpeedSlack_mps;
  posterior.log_evidence = logarithm(kind.share) - 0.5 * of_faces.misfit - 0.5 * too_fast * too_fast -
                           0.5 * misfitOf(kind.size, traits) + 0.5 * (prior.log_determinant - of_faces.log_determinant);
  return posterior;
}

}  // namespace

void FaceInformation::add(const Vector6d& row, double value, double sigma) {
  const double weight = 1 / (sigma * sigma);
  H += weight * row * row.transpose();
  b += weight * value * row;
  c += weight * value * value;
}

void FaceInformation::addReach(int face, double at, double sigma) {
  reach_weight[face] += 1 / (sigma * sigma);
  reach_sum[face] += at / (sigma * sigma);
}

void FaceInformation::add(const FaceInformation& more, double weight) {
  H += weight * more.H;
  b += weight * more.b;
  c += weight * more.c;
  reach_weight += weight * more.reach_weight;
  reach_sum += weight * more.reach_sum;
}

FaceInformation FaceInformation::shifted(const Eigen::Vector3d& shift) const {
  Vector6d by;
  by << shift.x(), shift.x(), shift.y(), shift.y(), shift.z(), shift.z();
  return {.H = H,
          .b = b + H * by,
          .c = c + 2 * b.dot(by) + by.dot(H * by),
          .reach_weight = reach_weight,
          .reach_sum = reach_sum + reach_weight.cwiseProduct(by)};
}

FacePosterior posteriorFaces(const FaceInformation& prior, const FaceInformation& evidence) {
  constexpr int kRounds = 3;  // a reach may push another face
  FaceInformation all = prior;
  all.add(evidence);
  Eigen::LLT<Matrix6d> llt(all.H);
  FacePosterior posterior{.faces = llt.solve(all.b), .covariance = {}, .misfit = 0, .log_determinant = 0};
  std::array<bool, 6> counts{};
  for (int round = 0; round < kRounds; ++round) {
    bool changed = false;
    for (int face = 0; face < 6; ++face) {
      const double weight = all.reach_weight[face], sum = all.reach_sum[face];
      if (counts[face] || weight <= 0 || outward(face) * (sum / weight - posterior.faces[face]) <= 0) continue;
      all.H(face, face) += weight, all.b[face] += sum, all.c += sum * sum / weight;
      counts[face] = changed = true;
    }
    if (!changed) break;
    llt.compute(all.H);
    posterior.faces = llt.solve(all.b);
  }
  posterior.covariance = inverse(llt);
  posterior.misfit = all.c - all.b.dot(posterior.faces);
  posterior.log_determinant = logDeterminant(llt);
  return posterior;
}

ObjectBox BoxEstimate::box() const {
  ObjectBox box{.center_body = 0.5 * (least() + most()),
                .size_m = most() - least(),
                .center_sigma_m = {},
                .size_sigma_m = {},
                .kind = kind};
  for (int axis = 0; axis < 3; ++axis) {
    const int lower = 2 * axis, upper = lower + 1;
    const double sum = covariance(lower, lower) + covariance(upper, upper), cross = 2 * covariance(lower, upper);
    box.center_sigma_m[axis] = 0.5 * std::sqrt(std::max(0.0, sum + cross));
    box.size_sigma_m[axis] = std::sqrt(std::max(0.0, sum - cross));
  }
  return box;
}

void BoxEstimate::reach(const Eigen::AlignedBox3d& part) {
  for (int axis = 0; axis < 3; ++axis) {
    if (part.min()[axis] > part.max()[axis]) continue;
    usual_least[axis] = std::min(usual_least[axis], part.min()[axis]);
    usual_most[axis] = std::max(usual_most[axis], part.max()[axis]);
    possible_least[axis] = std::min(possible_least[axis], usual_least[axis]);
    possible_most[axis] = std::max(possible_most[axis], usual_most[axis]);
  }
}

BoxEstimate estimateBox(const FaceInformation& evidence, const BodyTraits& traits, ObjectKind known) {
  std::array<Posterior, kKinds.size()> posteriors;
  for (std::size_t i = 0; i < kKinds.size(); ++i) posteriors[i] = posteriorOf(kKinds[i], kPriors[i], evidence, traits);
  const auto likeliest = std::ranges::max_element(posteriors, {}, &Posterior::log_evidence);
  const auto rank = [&](const Posterior& p) {
    return std::pair(known == ObjectKind::kUnknown || p.estimate.kind == known, p.log_evidence);
  };
  BoxEstimate estimate = std::ranges::max_element(posteriors, {}, rank)->estimate;
  const bool small = known == ObjectKind::kPedestrian || known == ObjectKind::kTwoWheeler;
  const BoxEstimate& largest = small ? estimate : posteriors.front().estimate;  // a car's
  estimate.usual_least = estimate.least().cwiseMin(largest.least()),
  estimate.usual_most = estimate.most().cwiseMax(largest.most());
  estimate.possible_least = estimate.usual_least, estimate.possible_most = estimate.usual_most;
  for (const Posterior& p : posteriors) {
    if (p.log_evidence < likeliest->log_evidence + logarithm(kRuledOut)) continue;
    if (small && p.estimate.kind != known) continue;
    const Vector6d sigma = p.estimate.covariance.diagonal().cwiseSqrt();
    for (int axis = 0; axis < 3; ++axis) {
      double &least = estimate.possible_least[axis], &most = estimate.possible_most[axis];
      least = std::min(least, p.estimate.faces[2 * axis] - sigma[2 * axis]);
      most = std::max(most, p.estimate.faces[2 * axis + 1] + sigma[2 * axis + 1]);
    }
  }
  return estimate;
}

}  // namespace motorcade
