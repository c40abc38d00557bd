#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "frontend/messages.hpp"
#include "frontend/motion/point_track.hpp"
#include "frontend/motion/scene_flow.hpp"
#include "frontend/segmentation/motion_segmenter.hpp"
#include "tests/support/stereo_views.hpp"

namespace motorcade::test {

/// A car that the camera sees. World: x right, y down, z ahead, the road at y = 1.65 m. Body: x ahead, y left, z up, on
/// the road.
struct SimulatedCar {
  double x_m = 0, z_m = 15,
         heading_rad = 0;  // at the start; heading 0 drives along the world's z, positive turns right
  double speed_mps = 10, turn_rate_radps = 0;
  int points = 40;
  double size = 1;                                    // of the box on which they lie, over a car's
  int gone_from = 1'000'000, gone_until = 1'000'000;  // frames without any of its points
  int stands_from = 1'000'000, stands_until = 1'000'000;
};

/// A camera driving straight ahead among cars and points at rest: exact truth, noisy observations, and scene flow and
/// components made of them by the stages themselves. Call `next` once per frame.
class SimulatedTraffic {
 public:
  static constexpr double kDt_s = 0.1, kRoad_m = 1.65;

  SimulatedTraffic(std::vector<SimulatedCar> cars, double camera_speed_mps, std::uint64_t seed,
                   double odometry_sigma_m = 0.003)
      : cars_(std::move(cars)), camera_speed_mps_(camera_speed_mps), odometry_sigma_m_(odometry_sigma_m), noise_(seed) {
    for (const auto& car : cars_) {
      T_world_car_.push_back({poseOf(car)});
      std::vector<Eigen::Vector3d> points;
      for (int i = 0; i < car.points; ++i) points.push_back(car.size * pointOnBox());
      points_of_car_.push_back(points);
    }
    for (int i = 0; i < 120; ++i) {
      const double side = i % 2 ? 1 : -1;  // house fronts and parked things along the street
      street_.push_back({side * noise_.uniform(9, 14), kRoad_m - noise_.uniform(0.3, 5), noise_.uniform(5, 120)});
    }
  }

  SceneMotionPtr next() {
    const int frame = frame_++;
    auto scene = std::make_shared<SceneMotion>();
    scene->head.frame = {frame};
    scene->head.stamp = {static_cast<std::int64_t>(frame * kDt_s * 1e9)};
    if (frame > 0) driveOn(frame);
    const SE3 truth = frame > 0 ? SE3(Eigen::Matrix3d::Identity(), {0, 0, kDt_s * camera_speed_mps_}) : SE3{};
    scene->odometry.covariance.setZero();
    scene->odometry.covariance.diagonal().head<3>().setConstant(odometry_sigma_m_ * odometry_sigma_m_);
    scene->odometry.covariance.diagonal().tail<3>().setConstant(1e-3 * odometry_sigma_m_ *
                                                                odometry_sigma_m_);  // 0.03 rad per meter
    scene->odometry.T_previous_now =
        frame > 0 ? truth * SE3::exp(noise_.correlated(scene->odometry.covariance)) : SE3{};
    trail_.add(scene->head.stamp, scene->odometry.T_previous_now);
    for (std::size_t c = 0; c < cars_.size(); ++c) seeCar(c, frame);
    for (std::size_t i = 0; i < street_.size(); ++i)
      see({-1, static_cast<int>(i)}, camera(frame).inverse() * street_[i], true);
    fill(*scene);
    return scene;
  }

  /// True poses.
  SE3 camera(int frame) const { return {Eigen::Matrix3d::Identity(), {0, 0, kDt_s * camera_speed_mps_ * frame}}; }
  const SE3& car(std::size_t c, int frame) const { return T_world_car_[c][frame]; }
  SE3 carInCamera(std::size_t c, int frame) const { return camera(frame).inverse() * car(c, frame); }
  double speed(std::size_t c, int frame) const {
    const bool stands = frame >= cars_[c].stands_from && frame < cars_[c].stands_until;
    return stands ? 0 : cars_[c].speed_mps;
  }

 private:
  using ScenePointIndex = std::pair<int, int>;  // (car or -1 for the street, point)

  static SE3 poseOf(const SimulatedCar& car) {
    Eigen::Matrix3d upright;  // columns: ahead = world z, left = -world x, up = -world y
    upright << 0, -1, 0, 0, 0, -1, 1, 0, 0;
    return {expSO3({0, car.heading_rad, 0}) * upright, {car.x_m, kRoad_m, car.z_m}};
  }

  /// A point on one of the five visible faces of a car of 4.2 x 1.8 x 1.5 m.
  Eigen::Vector3d pointOnBox() {
    Eigen::Vector3d p = noise_.inBox({-2.1, -0.9, 0.2}, {2.1, 0.9, 1.5});
    const double face = noise_.uniform(0, 3);
    if (face < 1.5) {
      p.x() = p.x() < 0 ? -2.1 : 2.1;  // front and rear carry most of what a follower sees
    } else {
      p.y() = p.y() < 0 ? -0.9 : 0.9;
    }
    return p;
  }

  void driveOn(int frame) {
    for (std::size_t c = 0; c < cars_.size(); ++c) {
      const double turning =
          speed(c, frame) > 0 ? -cars_[c].turn_rate_radps : 0;  // about the body's z axis, which points up
      Vector6d twist;
      twist << speed(c, frame), 0, 0, 0, 0, turning;
      T_world_car_[c].push_back(T_world_car_[c].back() * SE3::exp(kDt_s * twist));
    }
  }

  void seeCar(std::size_t c, int frame) {
    const bool gone = frame >= cars_[c].gone_from && frame < cars_[c].gone_until;
    const SE3 T_cam_car = carInCamera(c, frame);
    const Eigen::Vector3d p_body_cam = T_cam_car.inverse() * Eigen::Vector3d(0, 0, 0);
    for (std::size_t i = 0; i < points_of_car_[c].size(); ++i) {
      const Eigen::Vector3d& p = points_of_car_[c][i];
      const bool on_end = std::abs(p.x()) == 2.1;
      const bool faces_camera =
          on_end ? p.x() * p_body_cam.x() > p.x() * p.x() : p.y() * p_body_cam.y() > p.y() * p.y();
      see({static_cast<int>(c), static_cast<int>(i)}, T_cam_car * p, !gone && faces_camera);
    }
  }

  /// Extends the point's track; a point that comes back gets a new id.
  void see(ScenePointIndex index, const Eigen::Vector3d& p_cam, bool visible) {
    const auto uvd = visible ? look(p_cam, noise_) : std::nullopt;
    if (!uvd) {
      name_.erase(index);
      return;
    }
    const auto [at, created] = name_.try_emplace(index, PointId{next_point_});
    next_point_ += created;
    PointTrack& track = seen_[at->second];
    track.point = at->second;
    track.add({trail_.newest().step, uvd->cast<float>(), kObservationSigma_px.cast<float>()});
  }

  void fill(SceneMotion& scene) {
    const SceneFlowEstimator flow({}, kRig);
    std::erase_if(seen_, [&](const auto& t) { return t.second.newest().step != trail_.newest().step; });
    for (const auto& [point, track] : seen_) {
      ScenePoint p{.point = point,
                   .uvd_px = track.newest().uvd_px.cast<double>(),
                   .sigma_px = kObservationSigma_px,
                   .age = track.count,
                   .flow = {}};
      if (const auto fits = flow.fit(track, trail_); fits.at_rest) p.flow = fits.moving;
      scene.points.push_back(p);
    }
    const MotionSegmenter segmenter({}, kRig);
    scene.components =
        segmenter(scene.points, std::vector<bool>(scene.points.size(), false), scene.ground, camera_speed_mps_);
  }

  std::vector<SimulatedCar> cars_;
  double camera_speed_mps_, odometry_sigma_m_;
  Noise noise_;
  int frame_ = 0;
  std::vector<std::vector<SE3>> T_world_car_;  // per car and frame
  std::vector<std::vector<Eigen::Vector3d>> points_of_car_;
  std::vector<Eigen::Vector3d> street_;
  CameraTrail trail_;
  std::map<ScenePointIndex, PointId> name_;
  std::map<PointId, PointTrack> seen_;
  std::int64_t next_point_ = 0;
};

}  // namespace motorcade::test
