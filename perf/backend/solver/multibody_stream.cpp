#include "perf/backend/solver/multibody_stream.hpp"

#include <Eigen/Cholesky>

#include "backend/pose_graph/pose_graph_params.hpp"

namespace motorcade::perf {
namespace {

PoseNoise noiseOf(const MotionSigma& sigma) { return independentNoise(poseSigmas(sigma.m, sigma.rad, sigma.rad)); }

PoseNoise robust(PoseNoise noise, RobustLoss loss, double scale) {
  noise.loss = loss;
  noise.loss_scale = scale;
  return noise;
}

PoseNoise smoothness(const PoseGraphParams& p) {
  return smoothMotionNoise(p.acceleration, MultibodyScene::kFrame_s, MultibodyScene::kFrame_s);
}

const PoseGraphParams kProduct;

}  // namespace

void MultibodyStream::addPrior(VariableId v, const SE3& mean, const MotionSigma& sigma) {
  solver_.addFactor(std::make_unique<PriorFactor>(std::array{v}, PriorModel{mean}, noiseOf(sigma)));
}

void MultibodyStream::add(const SimulatedFrame& frame) {
  addCamera(frame);
  objects_.resize(frame.objects.size());
  for (std::size_t i = 0; i < objects_.size(); ++i) addObject(objects_[i], frame.objects[i]);
  for (std::size_t i = 0; i < frame.encounters.size(); ++i) {
    const Object &m = objects_[2 * i], &n = objects_[2 * i + 1];
    solver_.addFactor(std::make_unique<ObjectEncounterFactor>(std::array{m.anchor, m.z_last, n.anchor, n.z_last},
                                                              ObjectEncounterModel{frame.encounters[i]},
                                                              noiseOf(MultibodyScene::kObjectEncounter)));
  }
}

void MultibodyStream::addCamera(const SimulatedFrame& frame) {
  Record record{.x = {}, .T_world_cam = frame.T_world_cam, .of_frame = {}};
  if (records_.empty()) {
    record.x = solver_.addVariable(SE3{});
    addPrior(record.x, SE3{}, {kProduct.first_pose_sigma_m, kProduct.first_pose_sigma_rad});
  } else {
    const VariableId before = records_.back().x;
    record.x = solver_.addVariable((solver_.pose(before) * frame.T_previous_now).normalized());
    solver_.addFactor(std::make_unique<MotionFactor>(std::array{before, record.x}, MotionModel{frame.T_previous_now},
                                                     noiseOf(MultibodyScene::kOdometry)));
  }
  record.of_frame.push_back(record.x);
  records_.push_back(std::move(record));
}

void MultibodyStream::startObject(Object& object, const SimulatedFrame::Object& seen) {
  // The last frame of the object before it was the previous one.
  if (object.anchor.valid()) records_[records_.size() - 2].of_frame.push_back(object.anchor);
  const SE3 T_world_body = (solver_.pose(records_.back().x) * seen.T_cam_body).normalized();
  object = {.anchor = solver_.addVariable(T_world_body), .z_before_last = {}, .z_last = solver_.addVariable(SE3{})};
  addPrior(object.anchor, T_world_body, {kProduct.anchor_sigma_m, kProduct.anchor_sigma_rad});
  addPrior(object.z_last, SE3{}, {kProduct.object_origin_sigma_m, kProduct.object_origin_sigma_rad});
}

void MultibodyStream::addObject(Object& object, const SimulatedFrame::Object& seen) {
  if (seen.is_new || !object.anchor.valid()) {
    startObject(object, seen);
  } else {
    const VariableId before = object.z_last, before_that = object.z_before_last;
    object.z_last = solver_.addVariable((solver_.pose(before) * seen.T_before_now).normalized());
    object.z_before_last = before;
    solver_.addFactor(std::make_unique<MotionFactor>(
        std::array{before, object.z_last}, MotionModel{seen.T_before_now},
        robust(noiseOf(MultibodyScene::kObjectMotion), kProduct.motion_loss, kProduct.motion_loss_scale)));
    if (before_that.valid())
      solver_.addFactor(std::make_unique<SmoothMotionFactor>(
          std::array{before_that, before, object.z_last},
          SmoothMotionModel{MultibodyScene::kFrame_s, MultibodyScene::kFrame_s}, smoothness(kProduct)));
  }
  solver_.addFactor(std::make_unique<CameraEncounterFactor>(
      std::array{records_.back().x, object.anchor, object.z_last}, CameraEncounterModel{seen.T_cam_body},
      robust(noiseOf(MultibodyScene::kCameraEncounter), kProduct.encounter_loss, kProduct.encounter_loss_scale)));
  records_.back().of_frame.push_back(object.z_last);
}

std::vector<VariableId> MultibodyStream::takeRetired() {
  std::vector<VariableId> retired;
  while (window_frames_ > 0 && records_.size() > window_frames_) {
    retired.insert(retired.end(), records_.front().of_frame.begin(), records_.front().of_frame.end());
    records_.pop_front();
  }
  return retired;
}

std::optional<double> MultibodyStream::normalizedError(std::size_t frames_back) const {
  if (frames_back >= records_.size()) return std::nullopt;
  const Record &before = records_[records_.size() - 1 - frames_back], &now = records_.back();
  const auto joint = solver_.jointCovariance(std::array{before.x, now.x});
  if (!joint) return std::nullopt;
  const SE3 estimated = solver_.pose(before.x).inverse() * solver_.pose(now.x);
  const SE3 actual = before.T_world_cam.inverse() * now.T_world_cam;
  // estimated = before^-1 now: a perturbation of `before` shows on the right as -Ad(estimated^-1).
  Eigen::Matrix<double, 6, 12> J;
  J << -estimated.inverse().adjoint(), Matrix6d::Identity();
  const Matrix6d covariance = J * *joint * J.transpose();
  const Vector6d error = (actual.inverse() * estimated).log();
  return error.dot(covariance.ldlt().solve(error)) / 6;
}

}  // namespace motorcade::perf
