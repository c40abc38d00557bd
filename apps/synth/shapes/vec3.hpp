#pragma once

#include <algorithm>
#include <cmath>

/// Single precision vectors for the ray caster: relative to the camera, coordinates are exact to a few micrometers.
namespace motorcade::synth {

struct Vec3 {
  float x = 0, y = 0, z = 0;

  float& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  float operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  Vec3 operator+(const Vec3& o) const { return {x + o.x, y + o.y, z + o.z}; }
  Vec3 operator-(const Vec3& o) const { return {x - o.x, y - o.y, z - o.z}; }
  Vec3 operator*(float s) const { return {x * s, y * s, z * s}; }
  Vec3 operator*(const Vec3& o) const { return {x * o.x, y * o.y, z * o.z}; }
};

inline float dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline float norm(const Vec3& a) { return std::sqrt(dot(a, a)); }
inline Vec3 normalized(const Vec3& a) { return a * (1.0F / norm(a)); }
inline Vec3 min(const Vec3& a, const Vec3& b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
inline Vec3 max(const Vec3& a, const Vec3& b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }

/// Rotation with rows, and its transpose.
struct Rotation {
  Vec3 row0, row1, row2;
  Vec3 operator*(const Vec3& v) const { return {dot(row0, v), dot(row1, v), dot(row2, v)}; }
  Vec3 transposed(const Vec3& v) const { return row0 * v.x + row1 * v.y + row2 * v.z; }
};

}  // namespace motorcade::synth
