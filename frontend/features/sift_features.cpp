#include "frontend/features/sift_features.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <opencv2/features2d.hpp>

namespace motorcade {
namespace {

/// Greatest distance of matching descriptors, whose norm is about 512. It bounds matches without a second nearest
/// candidate, which the ratio cannot judge.
constexpr double kMaxDistance = 250;

// Parameters of Lowe (2004): three scales per octave, and a contrast threshold that OpenCV divides by their number.
constexpr int kOctaveLayers = 3;
constexpr double kContrastThreshold = 0.03;

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

SiftPoints SiftDetector::operator()(const Image& image) const {
  const cv::Mat view(image.height(), image.width(), CV_8UC1, const_cast<std::uint8_t*>(image.data()), image.stride());
  const auto sift = cv::SIFT::create(params_.max_points, kOctaveLayers, kContrastThreshold);
  std::vector<cv::KeyPoint> keypoints;
  cv::Mat descriptors;
  sift->detectAndCompute(view, cv::noArray(), keypoints, descriptors);

  SiftPoints points;
  for (int i = 0; i < static_cast<int>(keypoints.size()); ++i) {
    const cv::KeyPoint& keypoint = keypoints[i];
    // Keypoints at the same position with different orientations follow one another and are one point.
    if (!points.corners.empty() && points.corners.back().u_px == keypoint.pt.x &&
        points.corners.back().v_px == keypoint.pt.y)
      continue;
    points.corners.push_back({keypoint.pt.x, keypoint.pt.y, keypoint.response});
    SiftDescriptor& descriptor = points.descriptors.emplace_back();
    std::copy_n(descriptors.ptr<float>(i), descriptor.size(), descriptor.begin());
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
