#include "apps/evaluate/covariance_measures.hpp"

#include <map>
#include <utility>

#include <Eigen/Cholesky>

#include "apps/evaluate/object_positions.hpp"

namespace motorcade {
namespace {

constexpr std::int64_t kEveryFrames = 5;    // errors of neighboring frames are nearly the same
constexpr double kChiSquare95 = 12.591587;  // 95 % quantile, 6 degrees of freedom

void add(CovarianceErrors& errors, const SE3& estimate, const SE3& truth, const Matrix6d& covariance) {
  const Eigen::LLT<Matrix6d> cholesky(covariance);
  if (cholesky.info() != Eigen::Success) return;
  const Vector6d xi = (estimate.inverse() * truth).log();
  const double nees = xi.dot(cholesky.solve(xi));
  errors.mean_nees += nees;
  errors.coverage_95 += nees <= kChiSquare95;
  ++errors.samples;
}

CovarianceErrors averaged(CovarianceErrors errors) {
  if (errors.samples == 0) return errors;
  errors.mean_nees /= errors.samples;
  errors.coverage_95 /= errors.samples;
  return errors;
}

}  // namespace

CovarianceErrors cameraCovarianceErrors(const std::vector<ComparedFrame>& frames,
                                        const std::vector<RunFolder::CovarianceRow>& rows) {
  CovarianceErrors errors;
  for (const auto& row : rows) {
    const std::int64_t now = frames.empty() ? -1 : row.frame.value - frames.front().frame.value;
    if (row.track.valid() || row.frame.value % kEveryFrames != 0 || now < kCameraCovarianceFrames ||
        now >= std::ssize(frames))
      continue;
    const auto &to = frames[now], &from = frames[now - kCameraCovarianceFrames];
    add(errors, from.T_world_cam.inverse() * to.T_world_cam, from.T_world_cam_true.inverse() * to.T_world_cam_true,
        row.covariance);
  }
  return averaged(errors);
}

CovarianceErrors objectCovarianceErrors(const std::vector<ComparedFrame>& frames,
                                        const std::vector<RunFolder::CovarianceRow>& rows) {
  struct FollowedObject {
    std::vector<SE3> bodies, boxes;  // seen from the camera
    std::vector<FrameId> frames;
  };
  std::map<TrackId, FollowedObject> tracks;
  for (const auto& frame : frames) {
    for (const auto& row : frame.rows) {
      if (row.object < 0 || !frame.objects[row.object].ever_moves) continue;
      FollowedObject& track = tracks[row.row.object.track];
      track.bodies.push_back(frame.T_world_cam.inverse() * row.row.object.T_world_body);
      track.boxes.push_back(frame.objects[row.object].truth.T_cam_object);
      track.frames.push_back(frame.frame);
    }
  }
  std::map<std::pair<TrackId, FrameId>, Matrix6d> covariances;
  for (const auto& row : rows)
    if (row.track.valid() && row.frame.value % kEveryFrames == 0) covariances[{row.track, row.frame}] = row.covariance;
  CovarianceErrors errors;
  for (const auto& [id, track] : tracks) {
    const SE3 T_box_body = bodyOffset(track.bodies, track.boxes).inverse();
    for (std::size_t i = 0; i < track.frames.size(); ++i) {
      const auto covariance = covariances.find({id, track.frames[i]});
      if (covariance != covariances.end())
        add(errors, track.bodies[i], track.boxes[i] * T_box_body, covariance->second);
    }
  }
  return averaged(errors);
}

}  // namespace motorcade
