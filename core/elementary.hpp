#pragma once

#include <cmath>

/// Elementary functions whose last bits are the same on every processor. Sums and products have a fixed order; the C
/// library instead uses fused multiplications where a processor has them. Errors are within two units in the last
/// place. Arguments that are not finite, or too large (angles beyond 1e9 rad), give not-a-number.
namespace motorcade {

struct SineCosine {
  double sine, cosine;
};
SineCosine sineCosine(double angle_rad);
double sine(double angle_rad);
double cosine(double angle_rad);

/// Angle of (x, y) from the x axis, in (-pi, pi]; 0 where both are 0.
double arcTangent(double y, double x);

/// Overflows to infinity beyond 709 and is 0 below -708.
double exponential(double x);
/// Logarithm of a positive number; minus infinity at 0.
double logarithm(double x);
/// Power of a positive base.
double power(double base, double exponent);

/// Length of (x, y), which is neither huge nor tiny.
inline double hypotenuse(double x, double y) { return std::sqrt(x * x + y * y); }
inline float hypotenuse(float x, float y) {
  return static_cast<float>(hypotenuse(static_cast<double>(x), static_cast<double>(y)));
}

}  // namespace motorcade
