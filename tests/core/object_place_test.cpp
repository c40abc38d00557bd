#include "core/object_place.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/matchers.hpp"
#include "tests/support/noise.hpp"

namespace motorcade {
namespace {

using test::IsNear;

constexpr double kQuarter_rad = std::numbers::pi / 2;

/// Body axes in the world's, heading to the left of the world's z axis.
Eigen::Matrix3d worldBody(double heading_rad) {
  Eigen::Matrix3d world_body;
  const double c = std::cos(heading_rad), s = std::sin(heading_rad);
  world_body << -s, -c, 0, 0, 0, -1, c, -s, 0;
  return world_body;
}

ObjectEstimate objectAt(const SE3& T_world_body) {
  ObjectEstimate object;
  object.T_world_body = T_world_body;
  object.cuboid = ObjectBox{};
  object.cuboid->center_body = {1.5, 0.25, -0.5};
  object.cuboid->center_sigma_m = {0.4, 0.1, 0.05};
  return object;
}

TEST(ObjectPlace, HeadsToTheLeftOfTheWorldsZAxisAndIsCenteredOnTheCuboid) {
  for (const double heading_rad : {0.0, kQuarter_rad, -kQuarter_rad, 3.0})
    EXPECT_NEAR(placeOf(objectAt(SE3(worldBody(heading_rad), {4, 1, 20}))).heading_rad, heading_rad, 1e-12);
  // Ahead is z, left -x, up -y.
  const ObjectPlace place = placeOf(objectAt(SE3(worldBody(0), {4, 1, 20})));
  EXPECT_THAT(place.center_world, IsNear(Eigen::Vector3d(3.75, 1.5, 21.5), 1e-12));
  EXPECT_EQ(place.centerSigma_m(), Eigen::Vector3d(0, 0, 0)) << "without a covariance nothing is known of it";
}

TEST(ObjectPlace, DeviationsAreOfTheWorldsAxes) {
  ObjectEstimate object = objectAt(SE3(worldBody(kQuarter_rad), {4, 1, 20}));  // heads along -x
  object.covariance = Matrix6d::Zero();
  EXPECT_THAT(placeOf(object).centerSigma_m(), IsNear(Eigen::Vector3d(0.4, 0.05, 0.1), 1e-12));
  EXPECT_EQ(placeOf(object).heading_sigma_rad, 0);
  (*object.covariance)(5, 5) = 0.02 * 0.02;  // turned about the axis up: the middle moves by .02 * (1.5 left, .25 back)
  EXPECT_NEAR(placeOf(object).heading_sigma_rad, 0.02, 1e-12);
  EXPECT_THAT(placeOf(object).centerSigma_m(),
              IsNear(Eigen::Vector3d(std::hypot(0.4, 0.005), 0.05, std::hypot(0.1, 0.03)), 1e-12));
}

TEST(ObjectPlace, TellsNumbersAlsoOfWhatCannotBe) {
  ObjectEstimate object = objectAt(SE3(expSO3({0, 0, kQuarter_rad}), {4, 1, 20}));  // its x axis points down
  object.covariance = Matrix6d::Identity();
  EXPECT_EQ(placeOf(object).heading_sigma_rad, 2 * kQuarter_rad);
  object.covariance->setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(placeOf(object).centerSigma_m(), Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(placeOf(object).heading_sigma_rad, 0);
}

TEST(ObjectPlace, WithoutACuboidItIsThatOfTheBodysOrigin) {
  ObjectEstimate object = objectAt(SE3(worldBody(0.3), {4, 1, 20}));
  object.cuboid.reset();
  EXPECT_EQ(placeOf(object).center_world, Eigen::Vector3d(4, 1, 20));
}

TEST(ObjectPlace, DeviationsAreThoseOfDrawnPosesAndCuboids) {
  test::Noise noise(3);
  ObjectEstimate object = objectAt(SE3(worldBody(0.7) * expSO3({0.05, -0.1, 0}), {4, 1, 20}));
  const Vector6d sigma{0.2, 0.1, 0.05, 0.01, 0.02, 0.03};
  object.covariance = test::randomCovariance(noise, sigma);
  const ObjectPlace mean = placeOf(object);
  constexpr int kDraws = 20'000;
  Eigen::Vector3d center_squares = Eigen::Vector3d::Zero();
  double heading_squares = 0;
  for (int i = 0; i < kDraws; ++i) {
    ObjectEstimate drawn = object;
    drawn.T_world_body = object.T_world_body * SE3::exp(noise.correlated(*object.covariance));
    drawn.cuboid->center_body += noise.gaussian(object.cuboid->center_sigma_m);
    const ObjectPlace place = placeOf(drawn);
    center_squares += (place.center_world - mean.center_world).cwiseAbs2();
    heading_squares += std::pow(std::remainder(place.heading_rad - mean.heading_rad, 4 * kQuarter_rad), 2);
  }
  constexpr double kTolerance =
      0.03;  // a variance of 20,000 draws is good to 1 %, its root to .5 %, and terms of 2nd order
  const Eigen::Vector3d center_sigma_m = (center_squares / kDraws).cwiseSqrt();
  EXPECT_THAT(mean.centerSigma_m().cwiseQuotient(center_sigma_m), IsNear(Eigen::Vector3d(1, 1, 1), kTolerance));
  EXPECT_NEAR(mean.heading_sigma_rad / std::sqrt(heading_squares / kDraws), 1, kTolerance);
}

}  // namespace
}  // namespace motorcade
