#include "frontend/tracking/object_kinematics.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <gtest/gtest.h>

#include "core/decompositions.hpp"
#include "tests/support/matchers.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/numeric_jacobian.hpp"

namespace motorcade {
namespace {

using test::IsNear;
using test::IsNearPose;
using Vector12d = Eigen::Matrix<double, 12, 1>;

/// A car in a bend, its state known with all kinds of correlation.
struct CarInBend {
  SE3 T_world_body;
  Vector6d twist;
  Matrix12d covariance;

  explicit CarInBend(std::uint64_t seed) {
    test::Noise noise(seed);
    Vector6d pose;
    pose << 3, 1, 20, 0.3, -1.2, 0.4;
    T_world_body = SE3::exp(pose);
    twist << 9, 0.4, -0.1, 0.02, -0.03, 0.35;
    Vector12d sigma;
    sigma << 0.3, 0.2, 0.1, 0.02, 0.03, 0.05, 0.8, 0.5, 0.3, 0.05, 0.05, 0.1;
    covariance = test::randomCovariance(noise, sigma);
  }
  ObjectKinematics kinematics() const { return {T_world_body, twist, covariance}; }
};

/// Parameters without noise on acceleration.
ObjectKinematics::Params frictionless() {
  ObjectKinematics::Params p;
  p.acceleration = {0, 0, 0, 0, 0};
  return p;
}

TEST(ObjectKinematics, PredictsAConstantTwist) {
  const CarInBend car(1);
  ObjectKinematics k = car.kinematics();
  for (int i = 0; i < 10; ++i) k.predict(0.1, {});
  EXPECT_THAT(k.pose(), IsNearPose(car.T_world_body * SE3::exp(car.twist), 1e-12));  // rounding
  EXPECT_EQ(k.twist(), car.twist);
}

TEST(ObjectKinematics, APointObservedOnTheBodyDrawsItThere) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const CarInBend car(seed);
    const Eigen::Vector3d p_body(2, -0.5, 0.7),
        seen_world = car.T_world_body * p_body + Eigen::Vector3d(0.04, -0.02, 0.03);
    const auto distance = [&](double sigma_m) {
      ObjectKinematics k = car.kinematics();
      k.fusePosition(p_body, seen_world, sigma_m);
      return (k.pose() * p_body - seen_world).norm();
    };
    const double before_m = (car.T_world_body * p_body - seen_world).norm();
    EXPECT_LT(distance(1e-3), 0.03 * before_m) << seed;  // trusted: all the way
    EXPECT_LT(distance(0.2), before_m) << seed;
    EXPECT_NEAR(distance(100), before_m, 1e-3) << seed;  // not trusted: nowhere

    ObjectKinematics k = car.kinematics();
    k.fusePosition(p_body, car.T_world_body * p_body, 0.2);
    EXPECT_THAT(k.pose(), IsNearPose(car.T_world_body, 1e-12)) << seed;  // as expected: only surer
    EXPECT_LT(k.poseCovariance().trace(), car.kinematics().poseCovariance().trace()) << seed;
  }
}

TEST(ObjectKinematics, PredictedCovarianceFollowsTheFiniteDifferencesOfTheMotion) {
  constexpr double kDt_s = 0.3;
  const CarInBend car(2);
  ObjectKinematics k = car.kinematics();
  k.predict(kDt_s, frictionless());
  const auto error = [&](const Vector12d& x) {
    const SE3 moved = car.T_world_body * SE3::exp(x.head<6>()) * SE3::exp(kDt_s * (car.twist + x.tail<6>()));
    Vector12d e;
    e << (k.pose().inverse() * moved).log(), x.tail<6>();
    return e;
  };
  const Matrix12d F = test::numericJacobian(error, Vector12d::Zero().eval());
  const Matrix12d expected = F * car.covariance * F.transpose();
  constexpr double kTol = 1e-8;  // of central differences, for entries below one
  EXPECT_THAT(k.poseCovariance(), IsNear(expected.topLeftCorner<6, 6>(), kTol));
  EXPECT_THAT(k.velocityCovariance(), IsNear((expected.block<3, 3>(6, 6)), kTol));
}

TEST(ObjectKinematics, NoiseOfTwoHalfStepsIsThatOfAWhole) {
  const Matrix12d P = 0.01 * Matrix12d::Identity();
  ObjectKinematics whole({}, Vector6d::Zero(), P), halves = whole;  // at rest, where the motion is linear
  whole.predict(0.2, {});
  halves.predict(0.1, {});
  halves.predict(0.1, {});
  EXPECT_THAT(halves.poseCovariance(), IsNear(whole.poseCovariance(), 1e-14));  // rounding
  EXPECT_THAT(halves.velocityCovariance(), IsNear(whole.velocityCovariance(), 1e-14));
  EXPECT_NEAR(whole.velocityCovariance()(0, 0), 0.01 + 4 * 0.2, 1e-12);  // 2 m/s^2 along, white
}

TEST(ObjectKinematics, AcceptingAPoseIsAKalmanUpdateOfTheWholeState) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const CarInBend car(seed);
    test::Noise noise(seed);
    Vector6d sigma;
    sigma << 0.2, 0.2, 0.3, 0.03, 0.03, 0.03;
    const Matrix6d R = test::randomCovariance(noise, sigma);
    const Vector6d innovation = noise.correlated(R);

    Eigen::Matrix<double, 6, 12> H;
    H << Matrix6d::Identity(), Matrix6d::Zero();
    const Matrix6d S = H * car.covariance * H.transpose() + R;
    const Eigen::Matrix<double, 12, 6> K = car.covariance * H.transpose() * inverse(S);
    const Vector12d step = K * innovation;
    const Matrix12d P = (Matrix12d::Identity() - K * H) * car.covariance;

    ObjectKinematics k = car.kinematics();
    const SE3 posterior = car.T_world_body * SE3::exp(step.head<6>());
    k.acceptPose(posterior, P.topLeftCorner<6, 6>());
    constexpr double kTol = 1e-9;  // rounding, through covariances of condition 1e3
    EXPECT_THAT(k.pose(), IsNearPose(posterior, kTol));
    EXPECT_THAT(k.twist(), IsNear(car.twist + step.tail<6>(), kTol));
    EXPECT_THAT(k.velocityCovariance(), IsNear((P.block<3, 3>(6, 6)), kTol));

    ObjectKinematics expected(posterior, k.twist(), P);  // the correlations show after a prediction
    expected.predict(0.2, {});
    k.predict(0.2, {});
    EXPECT_THAT(k.poseCovariance(), IsNear(expected.poseCovariance(), kTol));
  }
}

TEST(ObjectKinematics, TheVehicleModelStopsSlipAndSetsTheBodyUpright) {
  const Eigen::Vector3d up(0, 0, 1);
  Vector6d tilt, twist;
  tilt << 1, 2, 3, 0.15, -0.1, 0;
  twist << 8, 3, 1, 0.3, 0.3, 0.2;
  ObjectKinematics k(SE3::exp(tilt), twist, Matrix12d::Identity());
  for (int i = 0; i < 50; ++i) k.fuseVehicleModel(up, {});
  // Against a prior of one, 50 updates of sigma s leave s^2 / 50 of a start: 0.025 m/s of the slip, less of all else.
  EXPECT_NEAR(k.twist()[1], 0, 0.05);
  EXPECT_NEAR(k.twist()[2], 0, 0.02);
  EXPECT_NEAR(k.twist()[3], 0, 0.01);
  EXPECT_NEAR(k.twist()[4], 0, 0.01);
  EXPECT_GT((k.pose().rotation() * Eigen::Vector3d::UnitZ()).dot(up), 0.9999);
  EXPECT_EQ(k.twist()[0], 8);  // neither the speed nor the turn rate was asked about
  EXPECT_EQ(k.twist()[5], 0.2);
  EXPECT_THAT(k.pose().translation(), IsNear(SE3::exp(tilt).translation(), 1e-12));
}

TEST(ObjectKinematics, ChangingTheBodyFrameKeepsTheMotionOfEveryPoint) {
  const CarInBend car(4);
  Vector6d other;
  other << 1.2, -0.4, 0.3, 0.1, -0.2, 0.7;
  const SE3 T_body_new = SE3::exp(other);
  const ObjectKinematics before = car.kinematics();
  ObjectKinematics after = before;
  after.changeBodyFrame(T_body_new);
  const auto velocity = [](const ObjectKinematics& k, const Eigen::Vector3d& p_body) -> Eigen::Vector3d {
    return k.pose().rotation() * (k.twist().head<3>() + k.twist().tail<3>().cross(p_body));
  };
  for (const Eigen::Vector3d& p_new :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(2, -1, 0.5), Eigen::Vector3d(-3, 0, 1)}) {
    EXPECT_THAT(after.pose() * p_new, IsNear(before.pose() * (T_body_new * p_new), 1e-12));  // rounding, here and below
    EXPECT_THAT(velocity(after, p_new), IsNear(velocity(before, T_body_new * p_new), 1e-12));
  }
  after.changeBodyFrame(T_body_new.inverse());
  EXPECT_THAT(after.poseCovariance(), IsNear(before.poseCovariance(), 1e-12));
  EXPECT_THAT(after.velocityCovariance(), IsNear(before.velocityCovariance(), 1e-12));
}

TEST(ObjectKinematics, PredictingCommutesWithTheChoiceOfBodyFrame) {
  const CarInBend car(5);
  const SE3 T_body_new(expSO3({0, 0, 0.6}), {1, -0.5, 0.2});
  ObjectKinematics a = car.kinematics(), b = a;
  a.predict(0.2, frictionless());
  a.changeBodyFrame(T_body_new);
  b.changeBodyFrame(T_body_new);
  b.predict(0.2, frictionless());
  EXPECT_THAT(a.pose(), IsNearPose(b.pose(), 1e-12));  // rounding
  EXPECT_THAT(a.poseCovariance(), IsNear(b.poseCovariance(), 1e-12));
}

}  // namespace
}  // namespace motorcade
