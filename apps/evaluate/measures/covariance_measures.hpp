#pragma once

#include <array>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "apps/evaluate/comparison/object_matching.hpp"
#include "core/se3.hpp"

/// Compares errors with the covariances that were estimated for them. Of a run every fifth frame counts, as errors of
/// neighboring frames are nearly the same.
namespace motorcade {

/// A reliability diagram of covariances: it tells whether errors along each axis lie within an interval as often as
/// their standard deviation says. The interval of a probability q holds q of a normal distribution around zero.
struct AxisReliability {
  static constexpr int kAxes = 6, kTenths = 10;  // of (rho, phi), and of the probability
  static constexpr std::array<const char*, kAxes> kAxisNames = {"x", "y", "z", "about_x", "about_y", "about_z"};

  /// The errors between the intervals of successive tenths: equally many where deviations are right.
  std::array<std::array<int, kTenths>, kAxes> errors{};

  /// Variances are positive.
  void add(const Vector6d& error, const Matrix6d& covariance);
  void add(const AxisReliability& other);
  int samples() const;
  /// The share of errors within the interval of `tenths` tenths.
  double shareWithin(int axis, int tenths) const;
};

/// A list of `errors` for each axis, by its name.
nlohmann::ordered_json jsonOf(const AxisReliability& reliability);
/// Throws the library's exception for any other JSON.
AxisReliability axisReliabilityOf(const nlohmann::json& json);

/// truth = estimate * exp(xi), xi ~ (0, covariance).
struct ErrorSample {
  Vector6d xi;
  Matrix6d covariance;
};

/// Normalized estimation errors squared, xi' covariance^-1 xi. Their mean is the number of degrees of freedom where
/// errors and covariances agree. The median shows whether a few frames or all of them are off.
struct NormalizedErrors {
  double mean_nees = 0, median_nees = 0;
  double coverage_95 = 0;  // share inside the 95 % region
};

struct CovarianceErrors {
  int samples = 0;
  NormalizedErrors pose;                // 6 degrees of freedom
  NormalizedErrors position, rotation;  // 3 each, by the blocks of the covariance
  AxisReliability by_axis;
};
/// Samples whose covariance is not positive definite are left out.
CovarianceErrors consistencyOf(const std::vector<ErrorSample>& samples);

/// The same body as two estimates see it from a camera, with a constant between their body frames: T_cam_body =
/// T_cam_other * Y. Right perturbations; a label has no covariance.
struct SeenTwice {
  SE3 T_cam_body, T_cam_other;
  Matrix6d covariance, other_covariance = Matrix6d::Zero();
};
/// The errors log(T_cam_body^-1 * T_cam_other * Y) of all frames with their covariances. Y minimizes them, weighted by
/// the covariances, so that uncertain frames do not bend what other frames know well.
std::vector<ErrorSample> errorsWithoutOffset(const std::vector<SeenTwice>& frames);

using CovarianceRows = std::vector<RunFolder::CovarianceRow>;

/// Errors of the camera's motion over kCameraCovarianceFrames; the truth's path is T_world_true * T_true_cam.
std::vector<ErrorSample> cameraErrorSamples(const std::vector<ComparedFrame>& frames, const CovarianceRows& rows,
                                            const SE3& T_true_cam = {});

/// Errors of the camera's pose since the first frame.
std::vector<ErrorSample> cameraPoseSamples(const std::vector<ComparedFrame>& frames, const CovarianceRows& rows,
                                           const SE3& T_true_cam = {});

/// The camera's normalized error squared in each frame that has a covariance, not only in every fifth frame.
struct FrameNees {
  FrameId frame;
  double nees = 0;
};
std::vector<FrameNees> cameraNees(const std::vector<ComparedFrame>& frames, const CovarianceRows& rows,
                                  const SE3& T_true_cam);

/// Errors of objects relative to the camera of the same frame, without the constant offset between body and label of
/// each track. Tracks with fewer than `kLeastFramesOfMean` frames are left out: the offset absorbs their errors.
std::vector<ErrorSample> objectErrorSamples(const std::vector<ComparedFrame>& frames, const CovarianceRows& rows);

/// Two runs of one drive whose measurements are independent: their difference has the sum of their covariances.
struct HalfErrors {
  CovarianceErrors camera, objects;
};
/// Compares two runs without any truth. Objects are matched by their distance as seen from the camera.
HalfErrors compareHalves(const RunFolder& a, const RunFolder& b);

}  // namespace motorcade
