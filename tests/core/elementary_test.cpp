#include "core/elementary.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace motorcade {
namespace {

using testing::IsNan;

constexpr double kPi = std::numbers::pi, kInfinity = std::numeric_limits<double>::infinity();
constexpr double kUnits = 2;  // in the last place, as the header says; the C library's own error is below one

/// Distance in units in the last place of the larger of `exact` and `least`, below which errors are absolute.
double unitsApart(double value, double exact, double least = 0) {
  const double unit = std::numeric_limits<double>::epsilon() * std::max(std::abs(exact), least);
  return std::abs(value - exact) / unit;
}

template <class Check>
void forManyNumbers(double from, double to, const Check& check) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> numbers(from, to);
  for (int i = 0; i < 100'000; ++i) check(numbers(random));
}

TEST(Elementary, SinesAndCosinesAreThoseOfTheCLibrary) {
  for (const double most : {1e-6, 1.0, 4.0, 1000.0})
    forManyNumbers(-most, most, [&](double x) {
      const auto [s, c] = sineCosine(x);
      ASSERT_LE(unitsApart(s, std::sin(x)), kUnits) << x;
      ASSERT_LE(unitsApart(c, std::cos(x)), kUnits) << x;
    });
  EXPECT_EQ(sine(0), 0);
  EXPECT_EQ(cosine(0), 1);
  EXPECT_THAT(sine(1e10), IsNan());
  EXPECT_THAT(cosine(kInfinity), IsNan());
}

TEST(Elementary, AnglesBeyondManyTurnsAreTakenToOne) {
  constexpr double kLost = 1e-6;  // of a million turns, as twice pi is not exact
  forManyNumbers(-1e7, 1e7, [&](double x) { ASSERT_NEAR(sine(x), std::sin(x), kLost) << x; });
}

TEST(Elementary, ArcTangentsAreRightInAllQuadrants) {
  forManyNumbers(-4, 4, [](double angle) {
    for (const double radius : {1e-200, 1.0, 1e200}) {
      const double y = radius * std::sin(angle), x = radius * std::cos(angle);
      ASSERT_LE(unitsApart(arcTangent(y, x), std::atan2(y, x)), kUnits) << angle;
    }
  });
  EXPECT_EQ(arcTangent(0, 0), 0);
  EXPECT_EQ(arcTangent(0, 1), 0);
  EXPECT_EQ(arcTangent(0, -1), kPi);
  EXPECT_EQ(arcTangent(1, 0), kPi / 2);
  EXPECT_EQ(arcTangent(-1, 0), -kPi / 2);
  EXPECT_THAT(arcTangent(kInfinity, 1), IsNan());
}

TEST(Elementary, ExponentialsAndLogarithmsAreThoseOfTheCLibrary) {
  forManyNumbers(-700, 700, [](double x) { ASSERT_LE(unitsApart(exponential(x), std::exp(x)), kUnits) << x; });
  forManyNumbers(-1, 1, [](double x) { ASSERT_LE(unitsApart(exponential(x), std::exp(x)), kUnits) << x; });
  for (const double most : {2.0, 1e300})
    forManyNumbers(0, most, [](double x) { ASSERT_LE(unitsApart(logarithm(x), std::log(x)), kUnits) << x; });
  EXPECT_EQ(exponential(0), 1);
  EXPECT_EQ(exponential(1000), kInfinity);
  EXPECT_EQ(exponential(-1000), 0);
  EXPECT_EQ(logarithm(1), 0);
  EXPECT_EQ(logarithm(0), -kInfinity);
  EXPECT_THAT(logarithm(-1), IsNan());
}

TEST(Elementary, PowersAreAsExactAsTheirLogarithm) {
  constexpr double kUnitsOfPower = 50;  // the error of a logarithm of up to twenty, twice
  forManyNumbers(0.1, 3, [&](double x) { ASSERT_LE(unitsApart(power(x, 7.5), std::pow(x, 7.5)), kUnitsOfPower) << x; });
}

TEST(Elementary, LengthsAreThoseOfTheCLibrary) {
  forManyNumbers(-1e3, 1e3, [](double x) {
    ASSERT_LE(unitsApart(hypotenuse(x, 3.25), std::hypot(x, 3.25)), kUnits);
    const auto y = static_cast<float>(x);
    ASSERT_EQ(hypotenuse(y, 3.25F), std::hypot(y, 3.25F));
  });
}

}  // namespace
}  // namespace motorcade
