#include "core/elementary.hpp"

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

namespace motorcade {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

/// Horner's rule, the highest coefficient last.
template <std::size_t kTerms>
double polynomial(const std::array<double, kTerms>& coefficients, double x) {
  double sum = coefficients[kTerms - 1];
  for (std::size_t i = kTerms - 1; i-- > 0;) sum = sum * x + coefficients[i];
  return sum;
}

/// 1 / (first + 0)!, 1 / (first + 2)!, ... with alternating signs, or 1 / (first + i)! with step 1 and one sign.
template <std::size_t kTerms>
constexpr std::array<double, kTerms> inverseFactorials(int first, int step, double sign) {
  std::array<double, kTerms> terms{};
  double factorial = 1, alternating = 1;
  int n = 0;
  for (std::size_t i = 0; i < kTerms; ++i) {
    while (n < first + static_cast<int>(i) * step) factorial *= ++n;
    terms[i] = alternating / factorial;
    alternating *= sign;
  }
  return terms;
}

/// 1, 1/3, 1/5, ... with alternating signs or one.
template <std::size_t kTerms>
constexpr std::array<double, kTerms> inverseOdds(double sign) {
  std::array<double, kTerms> terms{};
  double alternating = 1;
  for (std::size_t i = 0; i < kTerms; ++i, alternating *= sign) terms[i] = alternating / static_cast<double>(2 * i + 1);
  return terms;
}

/// Constants in parts. The upper parts have so many zeros that their multiples are exact.
constexpr double kHalfPiUpper = 0x1.921fb544p+0, kHalfPiMiddle = 0x1.0b4611a6p-34, kHalfPiLower = 0x1.3198a2e037073p-69;
constexpr double kLn2Upper = 0x1.62e42fefap-1, kLn2Lower = 0x1.cf79abc9e3b3ap-40;

/// Taylor series within a quarter of pi of zero.
double nearSine(double x) {
  static constexpr auto kTerms = inverseFactorials<8>(3, 2, -1);
  const double x2 = x * x;
  return x - x * x2 * polynomial(kTerms, x2);
}
double nearCosine(double x) {
  static constexpr auto kTerms = inverseFactorials<8>(4, 2, -1);
  const double x2 = x * x;
  return 1 - (0.5 * x2 - x2 * x2 * polynomial(kTerms, x2));
}

/// Arc tangent of a number between 0 and 1: that of the nearest quarter, and the series of the rest.
double nearArcTangent(double x) {
  static constexpr std::array kOfQuarter{0.0, 0x1.f5b75f92c80ddp-3, 0x1.dac670561bb4fp-2, 0x1.4978fa3269ee1p-1,
                                         std::numbers::pi / 4};
  static constexpr auto kTerms = inverseOdds<10>(-1);
  const int quarter = static_cast<int>(4 * x + 0.5);  // NOLINT(bugprone-incorrect-roundings): x is not negative
  const double c = 0.25 * quarter, rest = (x - c) / (1 + x * c);
  return kOfQuarter[static_cast<std::size_t>(quarter)] + rest * polynomial(kTerms, rest * rest);
}

}  // namespace

SineCosine sineCosine(double angle_rad) {
  constexpr double kLargest_rad = 1e9;
  if (!(std::abs(angle_rad) < kLargest_rad)) return {kNotANumber, kNotANumber};
  constexpr double kMostQuarters = 1 << 20;  // multiples of the upper part are exact up to here
  double angle = angle_rad;
  if (std::abs(angle) > kMostQuarters) angle = std::fmod(angle, 2 * std::numbers::pi);
  const double quarters = std::floor(angle * (2 / std::numbers::pi) + 0.5);
  const double rest = ((angle - quarters * kHalfPiUpper) - quarters * kHalfPiMiddle) - quarters * kHalfPiLower;
  const double s = nearSine(rest), c = nearCosine(rest);
  switch (static_cast<int>(quarters) & 3) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}
double sine(double angle_rad) { return sineCosine(angle_rad).sine; }
double cosine(double angle_rad) { return sineCosine(angle_rad).cosine; }

double arcTangent(double y, double x) {
  const double across = std::abs(y), along = std::abs(x);
  if (!(across + along < std::numeric_limits<double>::infinity())) return kNotANumber;
  if (across + along == 0) return 0;
  double angle =
      across <= along ? nearArcTangent(across / along) : std::numbers::pi / 2 - nearArcTangent(along / across);
  if (x < 0) angle = std::numbers::pi - angle;
  return y < 0 ? -angle : angle;
}

double exponential(double x) {
  constexpr double kLargest = 709, kSmallest = -708;
  if (x > kLargest) return std::numeric_limits<double>::infinity();
  if (x < kSmallest) return 0;
  if (std::isnan(x)) return kNotANumber;
  static constexpr auto kTerms = inverseFactorials<13>(2, 1, 1);
  const double doublings = std::floor(x * std::numbers::log2e + 0.5);
  const double rest = (x - doublings * kLn2Upper) - doublings * kLn2Lower;
  return std::ldexp(1 + (rest + rest * rest * polynomial(kTerms, rest)), static_cast<int>(doublings));
}

double logarithm(double x) {
  if (x == 0) return -std::numeric_limits<double>::infinity();
  if (!(x > 0 && x < std::numeric_limits<double>::infinity())) return kNotANumber;
  static constexpr auto kTerms = inverseOdds<12>(1);
  int doublings = 0;
  double mantissa = std::frexp(x, &doublings);
  if (mantissa < std::numbers::sqrt2 / 2) mantissa *= 2, --doublings;
  const double s = (mantissa - 1) / (mantissa + 1);
  return doublings * kLn2Upper + (doublings * kLn2Lower + 2 * s * polynomial(kTerms, s * s));
}

double power(double base, double exponent) { return exponential(exponent * logarithm(base)); }

}  // namespace motorcade
