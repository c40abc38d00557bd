#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "core/parameters.hpp"
#include "core/stereo_camera.hpp"
#include "frontend/geometry/point_grid.hpp"
#include "frontend/messages.hpp"

namespace motorcade {

/// A point of a stereo pair: (u, v, d) with independent standard deviations.
struct StereoObservation {
  Eigen::Vector3f uvd_px, sigma_px;
};

/// Disparities that are expected of a point before it is looked for in the right image.
struct ExpectedDisparity {
  double before_px;   // when the point was last observed
  double at_rest_px;  // now, if the point is at rest
};

struct ExpectedDisparities {
  std::vector<std::optional<ExpectedDisparity>> of_point;  // one per flow observation, empty for a new point
  bool motion_known = false;                               // else the camera was taken to stand still
  double offset_px = 0;                                    // true minus measured disparity
};

/// Mutual consistency over two stereo pairs. A point that optical flow followed from L(t-1) to L(t) is kept only if it
/// is found in R(t) near the disparity predicted from that between L(t-1) and R(t-1). Stateless.
class CircularMatching {
 public:
  struct Params {
    double sigma_flow_px = 0.25;  // standard deviations of the observations are never below these two
    double sigma_disparity_px = 0.25;
  };
  CircularMatching(const Params& params, const StereoCamera& camera) : params_(requireValid(params)), camera_(camera) {}

  /// Returns one item per flow observation, its disparity corrected by the offset; empty where the point was not found
  /// in the right image. Both messages are of the same frame.
  std::vector<std::optional<StereoObservation>> operator()(const StereoMatches& stereo, const OpticalFlow& flow,
                                                           const ExpectedDisparities& expected) const;

 private:
  std::optional<StereoMatch> firstDisparity(const StereoMatches& stereo, const PointGrid& corners,
                                            const FlowObservation& point) const;

  Params params_;
  StereoCamera camera_;
};

std::vector<Parameter> parametersOf(CircularMatching::Params& params);

}  // namespace motorcade
