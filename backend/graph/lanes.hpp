#pragma once

/// Vectors of four doubles for the kernels, which alone include this. GCC's vector extension turns them into the
/// processor's instructions.
namespace motorcade::lanes {

using Vec = double __attribute__((vector_size(32)));
// NOLINTNEXTLINE(modernize-use-using): only a typedef may lower an alignment
typedef double UnalignedVec __attribute__((vector_size(32), may_alias, aligned(8)));

/// Numbers in a vector of AVX.
constexpr int kLanes = 4;

inline Vec load(const double* from) { return *reinterpret_cast<const UnalignedVec*>(from); }
inline void store(double* to, Vec value) { *reinterpret_cast<UnalignedVec*>(to) = value; }
inline Vec broadcast(double value) { return Vec{value, value, value, value}; }
inline double sum(Vec v) { return (v[0] + v[2]) + (v[1] + v[3]); }

/// The rows of a 4 x 4 matrix become its columns.
inline void transpose(Vec& a, Vec& b, Vec& c, Vec& d) {
  const Vec even_ab = __builtin_shufflevector(a, b, 0, 4, 2, 6), odd_ab = __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Vec even_cd = __builtin_shufflevector(c, d, 0, 4, 2, 6), odd_cd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  a = __builtin_shufflevector(even_ab, even_cd, 0, 1, 4, 5);
  b = __builtin_shufflevector(odd_ab, odd_cd, 0, 1, 4, 5);
  c = __builtin_shufflevector(even_ab, even_cd, 2, 3, 6, 7);
  d = __builtin_shufflevector(odd_ab, odd_cd, 2, 3, 6, 7);
}

/// The first `count` of four numbers and zeros; reads nothing past them.
inline Vec loadFirst(const double* from, int count) {
  switch (count) {
    case 1:
      return Vec{from[0], 0, 0, 0};
    case 2:
      return Vec{from[0], from[1], 0, 0};
    case 3:
      return Vec{from[0], from[1], from[2], 0};
    default:
      return load(from);
  }
}

/// Calls `f.template operator()<n>()` with the number n of 1..kMax as a constant.
template <int kMax, class F>
[[gnu::always_inline]] inline void withConstant(int n, const F& f) {
  if constexpr (kMax > 1) {
    if (n < kMax) return withConstant<kMax - 1>(n, f);
  }
  f.template operator()<kMax>();
}

}  // namespace motorcade::lanes
