#include "apps/bridge/messages/message_conversion.hpp"

#include <gmock/gmock.h>

#include "tests/apps/bridge/bridged_object_by_hand.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/numeric_jacobian.hpp"

namespace motorcade::test {
namespace {

using Vector6Map = Eigen::Map<const Vector6d>;

constexpr double kTol = 1e-7;  // of central differences

/// Pose of a camera on the roof, looking down and to the left.
SE3 roof() { return turned({0, 0, 0.3}) * turned({0.02, 0.2, 0}, {1.6, -0.4, 1.5}); }

Result ofCamera() {
  Result result = bridgedResult({bridgedObject()});
  result.velocity = {9, 0.3, -0.2, 0.01, -0.03, 0.35};
  result.velocity_covariance = rowsByHand(unevenCovariance());
  result.motion_covariance = rowsByHand(Matrix6d(0.2 * unevenCovariance()));
  return result;
}

TEST(VehicleResult, IsTheCamerasWithoutAMounting) {
  const Result camera = ofCamera(), vehicle = seenFromVehicle(camera, SE3());
  EXPECT_EQ(vehicle.T_world_cam, camera.T_world_cam);
  EXPECT_EQ(vehicle.velocity, camera.velocity);
  EXPECT_EQ(vehicle.velocity_covariance, camera.velocity_covariance);
  EXPECT_EQ(vehicle.objects[0].T_world_body, camera.objects[0].T_world_body);
}

/// The world is the vehicle in the first pair; the camera's own world is the camera there.
TEST(VehicleResult, HasThePoseOfTheVehicleInItsOwnWorld) {
  const Result camera = ofCamera(), vehicle = seenFromVehicle(camera, roof());
  const SE3 T_world_vehicle = transformOf(vehicle.T_world_cam);
  EXPECT_THAT(roof() * transformOf(camera.T_world_cam), IsNearPose(T_world_vehicle * roof(), kRounding))
      << "two ways to the camera";
  Result first;
  first.T_world_cam = rowsByHand(SE3());
  EXPECT_THAT(transformOf(seenFromVehicle(first, roof()).T_world_cam), IsNearPose(SE3(), kRounding));
}

TEST(VehicleResult, SeesObjectsFromTheVehicle) {
  const Result vehicle = seenFromVehicle(ofCamera(), roof());
  const Result camera = ofCamera();
  const Result::Object &before = camera.objects[0], &object = vehicle.objects[0];
  EXPECT_THAT(transformOf(object.T_cam_body), IsNearPose(roof() * transformOf(before.T_cam_body), kRounding));
  EXPECT_THAT(transformOf(vehicle.T_world_cam) * transformOf(object.T_cam_body),
              IsNearPose(transformOf(object.T_world_body), kRounding))
      << "the same place in the world";
  EXPECT_EQ(object.covariance, before.covariance) << "of a perturbation in the body's own axes";
}

/// A velocity along the body's axes does not depend on where it is seen from.
TEST(VehicleResult, LeavesTheObjectsMotionAlongItsOwnAxesAsItIs) {
  const Result::Object before = ofCamera().objects[0], object = seenFromVehicle(ofCamera(), roof()).objects[0];
  const auto alongBody = [](const Result::Object& seen) {
    return Eigen::Vector3d(transformOf(seen.T_world_body).rotation().transpose() *
                           Eigen::Vector3d(seen.velocity_world_mps.data()));
  };
  const auto covarianceAlongBody = [](const Result::Object& seen) {
    const Eigen::Matrix3d R = transformOf(seen.T_world_body).rotation();
    return Eigen::Matrix3d(R.transpose() * Eigen::Map<const Eigen::Matrix3d>(seen.velocity_covariance.data()) * R);
  };
  EXPECT_THAT(alongBody(object), IsNear(alongBody(before), kRounding));
  EXPECT_THAT(covarianceAlongBody(object), IsNear(covarianceAlongBody(before), kRounding));
}

TEST(VehicleResult, HasTheTwistOfTheVehiclesOrigin) {
  const Result camera = ofCamera(), vehicle = seenFromVehicle(camera, roof());
  const auto moved = [&](const Eigen::Matrix<double, 1, 1>& dt_s) {
    return (roof() * SE3::exp(dt_s[0] * Vector6Map(camera.velocity.data())) * roof().inverse()).log();
  };
  const Vector6d expected = numericJacobian(moved, Eigen::Matrix<double, 1, 1>::Zero().eval());
  EXPECT_THAT(Vector6Map(vehicle.velocity.data()), IsNear(expected, kTol));
}

TEST(VehicleResult, HasTheCovariancesThatFiniteDifferencesSay) {
  const Result camera = ofCamera(), vehicle = seenFromVehicle(camera, roof());
  const auto twist = [&](const Vector6d& velocity) {
    Result other = camera;
    Eigen::Map<Vector6d>(other.velocity.data()) = velocity;
    return Vector6d(Vector6Map(seenFromVehicle(other, roof()).velocity.data()));
  };
  const Matrix6d J_twist = numericJacobian(twist, Vector6d(Vector6Map(camera.velocity.data())));
  EXPECT_THAT(matrixOfRows(vehicle.velocity_covariance),
              IsNear(Matrix6d(J_twist * unevenCovariance() * J_twist.transpose()), kTol));
  const SE3 T = turned({0.01, 0.02, 0.3}, {8, 1, 0.1});  // over ten frames
  const auto motion = [&](const SE3& T_moved) {
    return Vector6d((roof() * T.inverse() * T_moved * roof().inverse()).log());
  };
  const Matrix6d J = numericJacobian(motion, T);
  EXPECT_THAT(matrixOfRows(*vehicle.motion_covariance),
              IsNear(Matrix6d(0.2 * J * unevenCovariance() * J.transpose()), kTol));
}

/// An error of the camera's heading moves the vehicle's origin, two meters behind it, aside.
TEST(VehicleResult, GivesThePosesCovarianceOfTheVehicle) {
  Result camera;
  camera.pose_covariance = rowsByHand(diagonal(0.01, 0.0001));
  const Result vehicle = seenFromVehicle(camera, turned({0, 0, 0}, {2, 0, 0}));
  const Matrix6d covariance = matrixOfRows(vehicle.pose_covariance.value());
  EXPECT_NEAR(covariance(1, 1), 0.01 + 2 * 2 * 0.0001, kRounding);
  EXPECT_NEAR(covariance(1, 5), -2 * 0.0001, kRounding) << "turned to the left, the origin behind lies to the right";
  EXPECT_NEAR(covariance(5, 5), 0.0001, kRounding);
}

}  // namespace
}  // namespace motorcade::test
