#pragma once

#include <vector>

#include "apps/evaluate/comparison/object_matching.hpp"
#include "apps/evaluate/measures/consistency.hpp"

/// Compares the covariances of a run with the truth. Every fifth frame counts, as errors of neighboring frames are
/// nearly the same.
namespace motorcade {

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
