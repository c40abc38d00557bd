/// Vectors and matrices of which each entry is a vector of four numbers (core/lanes.hpp): a formula for one point,
/// written with them, is computed for four points.
#if defined(MOTORCADE_LANE_ALGEBRA) == defined(HWY_TARGET_TOGGLE)
#ifdef MOTORCADE_LANE_ALGEBRA
#undef MOTORCADE_LANE_ALGEBRA
#else
#define MOTORCADE_LANE_ALGEBRA
#endif

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "core/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {

inline constexpr std::size_t kDoubleLanes = 4;

/// Four vectors, four matrices by their rows, and four symmetric matrices by their upper triangles.
struct Doubles3 {
  Doubles x, y, z;
};
struct Doubles3x3 {
  Doubles3 x, y, z;
};
struct SymmetricDoubles3x3 {
  Doubles xx, xy, xz, yy, yz, zz;
};

HWY_INLINE Doubles3 allDoubles(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
HWY_INLINE Doubles3x3 allDoubles(const Eigen::Matrix3d& m) {
  return {allDoubles(Eigen::Vector3d(m.row(0))), allDoubles(Eigen::Vector3d(m.row(1))),
          allDoubles(Eigen::Vector3d(m.row(2)))};
}
HWY_INLINE void setLane(Doubles3& lanes, std::size_t lane, const Eigen::Vector3d& v) {
  const int i = static_cast<int>(lane);
  lanes.x.set(i, v.x()), lanes.y.set(i, v.y()), lanes.z.set(i, v.z());
}

HWY_INLINE Doubles3 operator+(const Doubles3& a, const Doubles3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
HWY_INLINE Doubles3 operator-(const Doubles3& a, const Doubles3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
HWY_INLINE Doubles3 operator*(const Doubles& scale, const Doubles3& v) {
  return {scale * v.x, scale * v.y, scale * v.z};
}
HWY_INLINE Doubles3& operator+=(Doubles3& a, const Doubles3& b) { return a = a + b; }
HWY_INLINE Doubles dot(const Doubles3& a, const Doubles3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
HWY_INLINE Doubles3 cross(const Doubles3& a, const Doubles3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

HWY_INLINE Doubles3 operator*(const Doubles3x3& m, const Doubles3& v) {
  return {dot(m.x, v), dot(m.y, v), dot(m.z, v)};
}
HWY_INLINE Doubles3 transposeTimes(const Doubles3x3& m, const Doubles3& v) { return v.x * m.x + v.y * m.y + v.z * m.z; }
HWY_INLINE Doubles3x3 transposeTimes(const Doubles3x3& m, const Doubles3x3& n) {
  return {m.x.x * n.x + m.y.x * n.y + m.z.x * n.z, m.x.y * n.x + m.y.y * n.y + m.z.y * n.z,
          m.x.z * n.x + m.y.z * n.y + m.z.z * n.z};
}
HWY_INLINE Doubles3x3& operator+=(Doubles3x3& a, const Doubles3x3& b) {
  a.x += b.x, a.y += b.y, a.z += b.z;
  return a;
}
HWY_INLINE Doubles3x3 operator*(const Doubles& scale, const Doubles3x3& m) {
  return {scale * m.x, scale * m.y, scale * m.z};
}

HWY_INLINE SymmetricDoubles3x3 operator*(const Doubles& scale, const SymmetricDoubles3x3& m) {
  return {scale * m.xx, scale * m.xy, scale * m.xz, scale * m.yy, scale * m.yz, scale * m.zz};
}
HWY_INLINE SymmetricDoubles3x3& operator+=(SymmetricDoubles3x3& a, const SymmetricDoubles3x3& b) {
  a.xx += b.xx, a.xy += b.xy, a.xz += b.xz, a.yy += b.yy, a.yz += b.yz, a.zz += b.zz;
  return a;
}
HWY_INLINE Doubles3 operator*(const SymmetricDoubles3x3& m, const Doubles3& v) {
  return {m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
          m.xz * v.x + m.yz * v.y + m.zz * v.z};
}
HWY_INLINE Doubles3x3 operator*(const SymmetricDoubles3x3& m, const Doubles3x3& n) {
  return {m.xx * n.x + m.xy * n.y + m.xz * n.z, m.xy * n.x + m.yy * n.y + m.yz * n.z,
          m.xz * n.x + m.yz * n.y + m.zz * n.z};
}
/// The product of a diagonal matrix with a vector or matrix.
HWY_INLINE Doubles3 scaledRows(const Doubles3& diagonal, const Doubles3& v) {
  return {diagonal.x * v.x, diagonal.y * v.y, diagonal.z * v.z};
}
HWY_INLINE Doubles3x3 scaledRows(const Doubles3& diagonal, const Doubles3x3& m) {
  return {diagonal.x * m.x, diagonal.y * m.y, diagonal.z * m.z};
}

/// a' b, where it is known to be symmetric.
HWY_INLINE SymmetricDoubles3x3 symmetricTransposeTimes(const Doubles3x3& a, const Doubles3x3& b) {
  return {a.x.x * b.x.x + a.y.x * b.y.x + a.z.x * b.z.x, a.x.x * b.x.y + a.y.x * b.y.y + a.z.x * b.z.y,
          a.x.x * b.x.z + a.y.x * b.y.z + a.z.x * b.z.z, a.x.y * b.x.y + a.y.y * b.y.y + a.z.y * b.z.y,
          a.x.y * b.x.z + a.y.y * b.y.z + a.z.y * b.z.z, a.x.z * b.x.z + a.y.z * b.y.z + a.z.z * b.z.z};
}
/// a b', where it is known to be symmetric.
HWY_INLINE SymmetricDoubles3x3 symmetricTimesTranspose(const Doubles3x3& a, const Doubles3x3& b) {
  return {dot(a.x, b.x), dot(a.x, b.y), dot(a.x, b.z), dot(a.y, b.y), dot(a.y, b.z), dot(a.z, b.z)};
}
/// Inverse of positive definite matrices.
HWY_INLINE SymmetricDoubles3x3 inverse(const SymmetricDoubles3x3& m) {
  const Doubles xx = m.yy * m.zz - m.yz * m.yz, xy = m.xz * m.yz - m.xy * m.zz, xz = m.xy * m.yz - m.xz * m.yy;
  const Doubles scale = 1.0 / (m.xx * xx + m.xy * xy + m.xz * xz);
  return {scale * xx,
          scale * xy,
          scale * xz,
          scale * (m.xx * m.zz - m.xz * m.xz),
          scale * (m.xy * m.xz - m.xx * m.yz),
          scale * (m.xx * m.yy - m.xy * m.xy)};
}

HWY_INLINE Eigen::Vector3d total(const Doubles3& v) { return {total(v.x), total(v.y), total(v.z)}; }
HWY_INLINE Eigen::Matrix3d total(const Doubles3x3& m) {
  Eigen::Matrix3d sum;
  sum << total(m.x).transpose(), total(m.y).transpose(), total(m.z).transpose();
  return sum;
}
HWY_INLINE Eigen::Matrix3d total(const SymmetricDoubles3x3& m) {
  const double xy = total(m.xy), xz = total(m.xz), yz = total(m.yz);
  Eigen::Matrix3d sum;
  sum << total(m.xx), xy, xz, xy, total(m.yy), yz, xz, yz, total(m.zz);
  return sum;
}

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
