#include "frontend/features/sift_features.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/module.hpp"

namespace motorcade {
namespace {

/// Greatest distance of matching descriptors, whose norm is about 512. It bounds matches without a second nearest
/// candidate, which the ratio cannot judge.
constexpr double kMaxDistance = 250;

float squaredDistance(const SiftDescriptor& a, const SiftDescriptor& b) {
  float sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

bool inRegion(const Corner& from, const Corner& to, const SiftSearchRegion& region) {
  const double du_px = to.u_px - from.u_px;
  return du_px >= region.min_du_px && du_px <= region.max_du_px && std::abs(to.v_px - from.v_px) <= region.max_dv_px;
}

/// Nearest and second nearest candidate of one point.
struct Nearest {
  int index = -1;
  float distance = std::numeric_limits<float>::max(), second = std::numeric_limits<float>::max();
  void offer(int candidate, float candidate_distance) {
    if (candidate_distance < distance) {
      second = std::exchange(distance, candidate_distance);
      index = candidate;
    } else {
      second = std::min(second, candidate_distance);
    }
  }
};

}  // namespace

extern "C" [[gnu::weak, gnu::visibility("hidden")]] decltype(motorcade_sift_1) motorcade_sift_1;

SiftDetector::SiftDetector(const Params& params) try
    : params_(requireValid(params)), detect_(linkedOrLoaded(&motorcade_sift_1, kSiftModule, kSiftFunction)) {
} catch (const ModuleError& error) {
  throw ModuleError(std::string("frontend.detector = \"sift\": ") + error.what());
}

SiftPoints SiftDetector::operator()(const Image& image) const {
  std::vector<SiftKeypoint> keypoints;
  std::string problem;
  detect_(
      {.pixels = image.data(), .width_px = image.width(), .height_px = image.height(), .stride_bytes = image.stride()},
      params_.max_points, keypoints, problem);
  if (!problem.empty()) throw std::runtime_error("SIFT: " + problem);
  SiftPoints points;
  for (const SiftKeypoint& keypoint : keypoints) {
    points.corners.push_back({keypoint.u_px, keypoint.v_px, keypoint.response});
    points.descriptors.push_back(keypoint.descriptor);
  }
  return points;
}

std::vector<int> matchSift(const std::vector<Corner>& from, const std::vector<SiftDescriptor>& from_descriptors,
                           const std::vector<Corner>& to, const std::vector<SiftDescriptor>& to_descriptors,
                           const SiftSearchRegion& region, double max_ratio) {
  std::vector<Nearest> forward(from.size()), backward(to.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    for (std::size_t j = 0; j < to.size(); ++j) {
      if (!inRegion(from[i], to[j], region)) continue;
      const float distance = squaredDistance(from_descriptors[i], to_descriptors[j]);
      forward[i].offer(static_cast<int>(j), distance);
      backward[j].offer(static_cast<int>(i), distance);
    }
  }
  std::vector<int> match(from.size(), -1);
  for (std::size_t i = 0; i < from.size(); ++i) {
    const Nearest& nearest = forward[i];
    const bool mutual = nearest.index >= 0 && backward[nearest.index].index == static_cast<int>(i);
    const double limit = std::min(max_ratio * max_ratio * nearest.second, kMaxDistance * kMaxDistance);
    if (mutual && nearest.distance < limit) match[i] = nearest.index;
  }
  return match;
}

std::vector<Parameter> parametersOf(SiftDetector::Params& params) {
  return {numberParameter("max_points", params.max_points, {100, 20000}, "more points to follow, at more cost")};
}

}  // namespace motorcade
