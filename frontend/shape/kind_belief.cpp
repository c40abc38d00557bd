#include "frontend/shape/kind_belief.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include <Eigen/Cholesky>

#include "core/decompositions.hpp"
#include "core/elementary.hpp"

namespace motorcade {
namespace {

// The body's origin is the median of points on it, which mostly lie on the faces in view.
constexpr double kAsideSigma_m = 0.7, kBottom_m = -0.8, kBottomSigma_m = 0.5;

}  // namespace

FacePrior facePrior(const UsualSize& size, double ahead_sigma_m) {
  FaceInformation prior;
  for (int axis = 0; axis < 3; ++axis) {
    Vector6d difference = Vector6d::Zero();
    difference[2 * axis] = -1, difference[2 * axis + 1] = 1;
    prior.add(difference, size.mean_m[axis], size.sigma_m[axis]);
  }
  Vector6d ahead = Vector6d::Zero(), aside = Vector6d::Zero(), bottom = Vector6d::Zero();
  ahead[kRear] = ahead[kFront] = aside[kRight] = aside[kLeft] = 0.5;
  bottom[kBottom] = 1;
  prior.add(ahead, 0, hypotenuse(ahead_sigma_m, 0.25 * size.mean_m.x()));
  prior.add(aside, 0, kAsideSigma_m);
  prior.add(bottom, kBottom_m, kBottomSigma_m);
  return {prior, logDeterminant(Eigen::LLT<Matrix6d>(prior.H))};
}

double misfitOf(const UsualSize& size, const BodyTraits& traits) {
  constexpr double kStandOut_m = 0.2;    // mirrors and bags, which a size leaves out
  constexpr double kMostByOthers = 6.0;  // one track in twenty holds points of another body: -2 log(0.05)
  const Eigen::Array3d sigma_m = (size.sigma_m.array().square() + kStandOut_m * kStandOut_m).sqrt();
  const Eigen::Array3d beyond = (traits.least_size_m - size.mean_m).array() / sigma_m;
  return std::min(kMostByOthers, beyond.max(0.0).square().sum());
}

double logDeterminant(const Eigen::LLT<Matrix6d>& llt) {
  const double root = Vector6d(llt.matrixLLT().diagonal()).prod();
  return 2 * logarithm(root);
}

namespace {

constexpr double kLeastNamed = 0.6;  // probability of a kind that is named: the others together are half as likely

/// Speeds of a kind that moves: a share of it is about a mean.
struct Pace {
  double share, mean_mps, sigma_mps;
};
/// Pedestrians walk at 1.34 +- 0.26 m/s (Weidmann 1993), and some run.
constexpr std::array kWalkers{Pace{0.9, 1.34, 0.26}, Pace{0.1, 2.5, 1}};
/// Bicycles are ridden at 17 +- 5 km/h; motorbikes are as fast as cars.
constexpr std::array kRiders{Pace{0.85, 4.7, 1.5}, Pace{0.15, 12, 6}};
/// Vehicles have any speed up to some 30 m/s, as good as evenly.
constexpr std::array<Pace, 0> kVehicles{};
constexpr double kEven_spm = 1 / 30.0;  // density of that
constexpr double kWaiting = 0.1;        // share of the time in which what moves on streets stands
constexpr double kSpeedSigma_mps = 0.3;

struct BelievedKind {
  ObjectKind kind;
  UsualSize size;
  double share;
  std::span<const Pace> paces;
};

/// Kinds with their shares of what moves on streets: most cars of KITTI's labels are parked, while nearly all that walk
/// or ride move. Vans are cars with a line of their own. Widths are between those with and without mirrors, which stand
/// out by 0.1 to 0.2 m at each side. What is none of these, as the crown of a tree or two objects in one, has any size.
const std::array<BelievedKind, 6> kKindsOfStreets{
    {{ObjectKind::kCar, {{4.1, 1.8, 1.55}, {0.5, 0.2, 0.15}}, 0.61, kVehicles},
     {ObjectKind::kCar, {{5.2, 2.05, 2.15}, {0.6, 0.25, 0.25}}, 0.1, kVehicles},
     {ObjectKind::kLargeVehicle, {{9.0, 2.55, 3.2}, {3, 0.2, 0.4}}, 0.08, kVehicles},
     {ObjectKind::kTwoWheeler, {{1.76, 0.6, 1.74}, {0.25, 0.12, 0.15}}, 0.08, kRiders},
     {ObjectKind::kPedestrian, {{0.84, 0.66, 1.76}, {0.25, 0.15, 0.13}}, 0.12, kWalkers},
     {ObjectKind::kUnknown, {{3, 1.5, 1.8}, {3, 1, 1}}, 0.01, kVehicles}}};

/// Deviation of the origin along the body: it slides over the frames of a track, and tells little of rear and front.
constexpr double kSlidingSigma_m = 5;

const std::array<FacePrior, kKindsOfStreets.size()> kPriorsOfStreets = [] {
  std::array<FacePrior, kKindsOfStreets.size()> priors;
  for (std::size_t i = 0; i < priors.size(); ++i) priors[i] = facePrior(kKindsOfStreets[i].size, kSlidingSigma_m);
  return priors;
}();

/// Error of the faces that all looks at an object share, so that more looks do not make it smaller.
struct SharedError {
  BoxFaces sigma_m;
  double share;
};
const std::array<SharedError, 2> kSharedErrors{
    // Bodies are not cuboids: ends are rounded and slanted, and half a pixel of disparity is 0.5 m at 20 m; mirrors
    // stand out by 0.2 m, which labels may count or not, and so do antennas, rails and hats.
    {{(BoxFaces() << 0.6, 0.6, 0.2, 0.2, 0.05, 0.15).finished(), 0.7},
     // The outline holds more than the object, as another vehicle or person beside, or a part alone.
     {(BoxFaces() << 4, 4, 1, 1, 0.05, 0.2).finished(), 0.3}}};

double normalDensity(double x, double mean, double sigma) {
  const double z = (x - mean) / sigma;
  return exponential(-0.5 * z * z) / (sigma * std::sqrt(2 * std::numbers::pi));
}

/// Probability density of a speed for a kind [s/m].
double densityOf(double speed_mps, std::span<const Pace> paces) {
  double moving = paces.empty() ? kEven_spm : 0;
  for (const Pace& pace : paces)
    moving += pace.share * normalDensity(speed_mps, pace.mean_mps, hypotenuse(pace.sigma_mps, kSpeedSigma_mps));
  constexpr double kLeast_spm = 1e-9;  // beyond all speeds of a kind, its logarithm stays finite
  return kLeast_spm + (1 - kWaiting) * moving + kWaiting * normalDensity(speed_mps, 0, kSpeedSigma_mps);
}

/// Evidence whose faces are off by one unknown shift, Gaussian, which is integrated out.
struct Blurred {
  FaceInformation evidence;
  double log_scale;
};

Blurred blurred(const FaceInformation& evidence, const BoxFaces& sigma_m) {
  const Vector6d of_shift = sigma_m.cwiseAbs2().cwiseInverse();
  Matrix6d both = evidence.H;
  both.diagonal() += of_shift;
  const Eigen::LLT<Matrix6d> llt(both);
  const Matrix6d covariance = inverse(llt);
  const Vector6d shift = covariance * evidence.b;
  Blurred result;
  result.evidence.H = -(of_shift.asDiagonal() * covariance * of_shift.asDiagonal());
  result.evidence.H.diagonal() += of_shift;
  result.evidence.b = of_shift.cwiseProduct(shift);
  result.evidence.c = evidence.c - evidence.b.dot(shift);
  for (int face = 0; face < 6; ++face) {
    const double share = 1 / (1 + evidence.reach_weight[face] * sigma_m[face] * sigma_m[face]);
    result.evidence.reach_weight[face] = share * evidence.reach_weight[face];
    result.evidence.reach_sum[face] = share * evidence.reach_sum[face];
  }
  result.log_scale = -0.5 * logDeterminant(llt) - logarithm(sigma_m.prod());
  return result;
}

/// One kind with one shared error: its likelihood and the faces.
struct Component {
  ObjectKind kind;
  double log_weight = 0, weight = 0;
  BoxFaces faces;
  Matrix6d covariance;
};
using Components = std::array<Component, kKindsOfStreets.size() * kSharedErrors.size()>;

/// Component of a kind; its weight is without the share of the kind and the density of the speed.
Component componentOf(ObjectKind kind, const FacePrior& prior, const Blurred& seen) {
  const FacePosterior posterior = posteriorFaces(prior.faces, seen.evidence);
  Component component{.kind = kind, .faces = posterior.faces, .covariance = posterior.covariance};
  component.log_weight =
      seen.log_scale - 0.5 * posterior.misfit + 0.5 * (prior.log_determinant - posterior.log_determinant);
  return component;
}

Components componentsOf(const FaceInformation& evidence, const BodyTraits& traits) {
  std::array<Blurred, kSharedErrors.size()> seen;
  for (std::size_t i = 0; i < seen.size(); ++i) {
    seen[i] = blurred(evidence, kSharedErrors[i].sigma_m);
    seen[i].log_scale += logarithm(kSharedErrors[i].share);
  }
  Components components;
  auto* component = components.data();
  for (std::size_t i = 0; i < kKindsOfStreets.size(); ++i) {
    const BelievedKind& kind = kKindsOfStreets[i];
    const double log_prior =
        logarithm(kind.share * densityOf(traits.speed_mps, kind.paces)) - 0.5 * misfitOf(kind.size, traits);
    for (const Blurred& blurry : seen) {
      *component = componentOf(kind.kind, kPriorsOfStreets[i], blurry);
      component++->log_weight += log_prior;
    }
  }
  const double most = std::ranges::max_element(components, {}, &Component::log_weight)->log_weight;
  double sum = 0;
  for (Component& c : components) sum += c.weight = exponential(c.log_weight - most);
  for (Component& c : components) c.weight /= sum;
  return components;
}

/// Root mean squares, over all components, of the distances of a middle and a size along an axis from a cuboid's.
void setSpread(ObjectBox& box, const Components& components, int axis) {
  const int lower = 2 * axis, upper = lower + 1;
  double of_center = 0, of_size = 0;
  for (const Component& c : components) {
    const double sum = c.covariance(lower, lower) + c.covariance(upper, upper), cross = 2 * c.covariance(lower, upper);
    const double center = 0.5 * (c.faces[upper] + c.faces[lower]) - box.center_body[axis];
    const double size = c.faces[upper] - c.faces[lower] - box.size_m[axis];
    of_center += c.weight * (0.25 * (sum + cross) + center * center);
    of_size += c.weight * (sum - cross + size * size);
  }
  box.center_sigma_m[axis] = std::sqrt(of_center), box.size_sigma_m[axis] = std::sqrt(of_size);
}

double probabilityOf(ObjectKind kind, const Components& components) {
  double probability = 0;
  for (const Component& c : components) probability += c.kind == kind ? c.weight : 0;
  return probability;
}

void setKind(ObjectBox& box, const Components& components) {
  box.kind = ObjectKind::kUnknown, box.kind_probability = 0;
  for (const BelievedKind& believed : kKindsOfStreets) {
    if (believed.kind == ObjectKind::kUnknown) continue;
    const double probability = probabilityOf(believed.kind, components);
    if (probability > kLeastNamed) box.kind = believed.kind;
    box.kind_probability = std::max(box.kind_probability, probability);
  }
}

}  // namespace

ObjectKind smallKind(const FaceInformation& evidence, const BodyTraits& traits, double least) {
  const Components components = componentsOf(evidence, traits);
  const double walks = probabilityOf(ObjectKind::kPedestrian, components),
               rides = probabilityOf(ObjectKind::kTwoWheeler, components);
  if (std::max(walks, rides) < least) return ObjectKind::kUnknown;
  return walks > rides ? ObjectKind::kPedestrian : ObjectKind::kTwoWheeler;
}

ObjectBox believedBox(const FaceInformation& evidence, const BodyTraits& traits) {
  const Components components = componentsOf(evidence, traits);
  ObjectBox believed;
  setKind(believed, components);
  const BoxEstimate estimate = estimateBox(evidence, traits, believed.kind);
  believed.center_body = 0.5 * (estimate.least() + estimate.most());
  believed.size_m = estimate.most() - estimate.least();
  for (int axis = 0; axis < 3; ++axis) setSpread(believed, components, axis);
  return believed;
}

}  // namespace motorcade
