#include "backend/joint/calibration_response.hpp"

#include <algorithm>
#include <iterator>

#include <Eigen/Cholesky>

namespace motorcade {
namespace {

constexpr std::int64_t kSpan_frames = 15, kOneOfPoints = 3;
constexpr double kLoosely = 1e-6;  // the information that holds poses which no landmark links [1/m^2, 1/rad^2]

bool isTaken(PointId point) { return point.value % kOneOfPoints == 0; }

using Shifts = Eigen::Matrix<double, Eigen::Dynamic, kCalibrationErrors>;
using Matrix64d = Eigen::Matrix<double, 6, 4>;

/// Sums of the normal equations H delta = -G: poses step by delta when the observations shift. Landmarks are
/// eliminated.
class ResponseSum {
 public:
  explicit ResponseSum(std::size_t frames)
      : H_(Eigen::MatrixXd::Identity(6 * frames, 6 * frames) * kLoosely),
        G_(Shifts::Zero(6 * frames, kCalibrationErrors)) {}

  /// Adds a landmark, with the `shifts` of each view's observation.
  void add(std::span<const LandmarkView> views, const LandmarkFit& fit, std::span<const ObservationShifts> shifts) {
    W_.clear();
    Eigen::Matrix<double, 4, kCalibrationErrors> of_landmark = Eigen::Matrix<double, 4, kCalibrationErrors>::Zero();
    for (std::size_t i = 0; i < views.size(); ++i) {
      const LinearView& linear = fit.views()[i];
      const Eigen::Matrix<double, 3, 6> A = linear.J.leftCols<6>();
      const Eigen::Matrix<double, 3, 4> B = linear.B;
      const Eigen::Index at = 6 * views[i].frame;
      W_.push_back(A.transpose() * B);
      H_.block<6, 6>(at, at).noalias() += A.transpose() * A;
      G_.middleRows<6>(at).noalias() += A.transpose() * shifts[i];
      of_landmark.noalias() += B.transpose() * shifts[i];
    }
    const Eigen::Matrix<double, 4, kCalibrationErrors> moved = fit.information().solve(of_landmark);
    for (std::size_t i = 0; i < views.size(); ++i) {
      const Matrix64d WV = fit.information().solve(W_[i].transpose()).transpose();
      G_.middleRows<6>(6 * views[i].frame).noalias() -= W_[i] * moved;
      for (std::size_t j = 0; j <= i; ++j)
        H_.block<6, 6>(6 * views[i].frame, 6 * views[j].frame).noalias() -= WV * W_[j].transpose();
    }
  }

  /// Solves for the steps; the first frame stays where it is.
  Shifts solved() const {
    Shifts steps = Shifts::Zero(G_.rows(), kCalibrationErrors);
    const Eigen::Index rest = G_.rows() - 6;
    if (rest > 0) steps.bottomRows(rest) = -H_.bottomRightCorner(rest, rest).llt().solve(G_.bottomRows(rest));
    return steps;
  }

 private:
  Eigen::MatrixXd H_;  // lower triangle
  Shifts G_;
  std::vector<Matrix64d> W_;
};

/// Shifts of the views' observations, whitened and weighted as the views are.
std::vector<ObservationShifts> weightedShifts(const StereoCamera& camera, const CalibrationSigmas& sigmas,
                                              std::span<const LandmarkView> views, const LandmarkFit& fit) {
  std::vector<ObservationShifts> shifts;
  for (std::size_t i = 0; i < views.size(); ++i) {
    const double of_d = fit.views()[i].J(2, 6);  // an offset is added to the disparity alone
    const Eigen::Vector3d weights = views[i].inverse_sigma * (of_d / views[i].inverse_sigma.z());
    shifts.push_back(weights.asDiagonal() * observationShifts(camera, sigmas, views[i].uvd_px));
  }
  return shifts;
}

/// Right perturbations of the poses, from steps in the world's axes.
Shifts inCameraAxes(Shifts shifts, const std::vector<SE3>& T_cam_world) {
  for (std::size_t k = 0; k < 2 * T_cam_world.size(); ++k)
    shifts.middleRows<3>(3 * k) = (T_cam_world[k / 2].rotation() * shifts.middleRows<3>(3 * k)).eval();
  return shifts;
}

}  // namespace

CalibrationResponse::CalibrationResponse(const StereoCamera& camera, const CalibrationSigmas& sigmas,
                                         const LandmarkNoise& noise, const BodyPoints::Params& points)
    : camera_(camera), sigmas_(sigmas), noise_(noise), points_(points) {}

void CalibrationResponse::observe(FrameId frame, std::span<const PointMeasurement> at_rest) {
  std::vector<PointMeasurement> some;
  std::ranges::copy_if(at_rest, std::back_inserter(some), [](const PointMeasurement& m) { return isTaken(m.point); });
  points_.observe(frame, some);
  std::ranges::move(points_.takeEnded(), std::back_inserter(ended_));
  std::erase_if(ended_, [&](const LandmarkTrack& track) {
    return track.views.front().frame.value <= frame.value - kSpan_frames;
  });
}

std::vector<LandmarkTrack*> CalibrationResponse::tracks() {
  std::vector<LandmarkTrack*> tracks = points_.current();
  for (LandmarkTrack& track : ended_) tracks.push_back(&track);
  return tracks;
}

std::vector<CalibrationResponse::FrameStep> CalibrationResponse::steps(const PoseVariable& camera,
                                                                       const std::function<SE3(VariableId)>& pose,
                                                                       const NoiseLevel& level, double offset_px) {
  const std::vector<LandmarkTrack*> landmarks = tracks();
  if (landmarks.empty()) return {};
  const FrameIndex index(landmarks, camera);
  std::vector<SE3> T_cam_world;
  for (const VariableId v : index.variables()) T_cam_world.push_back(pose(v).inverse());
  LandmarkFit fit(camera_, noise_, FramePose::kWorldCam, T_cam_world, offset_px);
  ResponseSum sum(index.frames().size());
  std::vector<LandmarkView> views;
  for (const LandmarkTrack* landmark : landmarks) {
    views.clear();
    index.append(landmark->views, level, views);
    if (views.size() >= 2 && fit(views)) sum.add(views, fit, weightedShifts(camera_, sigmas_, views, fit));
  }
  const Shifts shifts = inCameraAxes(sum.solved(), T_cam_world);
  std::vector<FrameStep> steps;
  for (std::size_t k = 1; k < index.frames().size(); ++k) {
    const Matrix6d by_before = (T_cam_world[k] * T_cam_world[k - 1].inverse()).adjoint();
    newest_ = shifts.middleRows<6>(6 * k) - by_before * shifts.middleRows<6>(6 * k - 6);
    steps.push_back({index.frames()[k - 1], index.frames()[k], newest_});
  }
  return steps;
}

}  // namespace motorcade
