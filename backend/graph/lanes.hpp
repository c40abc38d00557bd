/// Vectors of four doubles for the kernels of this folder, which alone include this (core/lanes.hpp).
#if defined(MOTORCADE_GRAPH_LANES) == defined(HWY_TARGET_TOGGLE)
#ifdef MOTORCADE_GRAPH_LANES
#undef MOTORCADE_GRAPH_LANES
#else
#define MOTORCADE_GRAPH_LANES
#endif

#include "core/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {

using Vec = Doubles;
constexpr int kLanes = 4;

HWY_INLINE Vec broadcast(double value) { return value; }
HWY_INLINE double sum(const Vec& v) { return (v[0] + v[2]) + (v[1] + v[3]); }
HWY_INLINE Vec four(double a, double b, double c, double d) {
  Vec v;
#if HWY_TARGET <= HWY_AVX2
  v.part[0] = Vec::Part{a, b, c, d};
#else
  v.part[0] = Vec::Part{a, b}, v.part[1] = Vec::Part{c, d};
#endif
  return v;
}

/// The rows of a 4 x 4 matrix become its columns.
HWY_INLINE void transpose(Vec& a, Vec& b, Vec& c, Vec& d) {
#if HWY_TARGET <= HWY_AVX2
  const auto even = [](const Vec& x, const Vec& y)
                        HWY_ATTR { return __builtin_shufflevector(x.part[0], y.part[0], 0, 4, 2, 6); };
  const auto odd = [](const Vec& x, const Vec& y)
                       HWY_ATTR { return __builtin_shufflevector(x.part[0], y.part[0], 1, 5, 3, 7); };
  const Vec::Part even_ab = even(a, b), odd_ab = odd(a, b), even_cd = even(c, d), odd_cd = odd(c, d);
  a.part[0] = __builtin_shufflevector(even_ab, even_cd, 0, 1, 4, 5);
  b.part[0] = __builtin_shufflevector(odd_ab, odd_cd, 0, 1, 4, 5);
  c.part[0] = __builtin_shufflevector(even_ab, even_cd, 2, 3, 6, 7);
  d.part[0] = __builtin_shufflevector(odd_ab, odd_cd, 2, 3, 6, 7);
#else
  const Vec rows[4]{a, b, c, d};
  const auto pair = [&rows](int row, int column) HWY_ATTR {
    const Vec::Part x = rows[row].part[column / 2], y = rows[row + 1].part[column / 2];
    return column % 2 == 0 ? __builtin_shufflevector(x, y, 0, 2) : __builtin_shufflevector(x, y, 1, 3);
  };
  a.part[0] = pair(0, 0), a.part[1] = pair(2, 0), b.part[0] = pair(0, 1), b.part[1] = pair(2, 1);
  c.part[0] = pair(0, 2), c.part[1] = pair(2, 2), d.part[0] = pair(0, 3), d.part[1] = pair(2, 3);
#endif
}

/// The first `count` of four numbers and zeros; reads nothing past them.
HWY_INLINE Vec loadFirst(const double* from, int count) {
  switch (count) {
    case 1:
      return four(from[0], 0, 0, 0);
    case 2:
      return four(from[0], from[1], 0, 0);
    case 3:
      return four(from[0], from[1], from[2], 0);
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

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
