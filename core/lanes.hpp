/// Vectors of 32 bytes by the compilers' vector extension: one of AVX2, or two of 16 bytes. Arithmetic is lane by lane,
/// so that a formula for one number, written with them, is computed for several, with the same bits on every processor.
/// For kernels alone, which Highway compiles once for each target: include this after <hwy/foreach_target.h>.
#if defined(MOTORCADE_LANES) == defined(HWY_TARGET_TOGGLE)
#ifdef MOTORCADE_LANES
#undef MOTORCADE_LANES
#else
#define MOTORCADE_LANES
#endif

#include <cstdint>
#include <cstring>
#include <type_traits>

#include <hwy/highway.h>

#include "core/instruction_set.hpp"
#if HWY_ARCH_X86
#include <immintrin.h>
#else
#include <arm_neon.h>
#endif

HWY_BEFORE_NAMESPACE();
namespace motorcade::HWY_NAMESPACE {

inline constexpr int kLaneBytes = 32, kPartBytes = HWY_TARGET <= HWY_AVX2 ? 32 : 16, kParts = kLaneBytes / kPartBytes;

/// Integers of a size, for masks: all bits are set, or none.
template <class T>
using MaskOf = std::conditional_t<
    sizeof(T) == 1, std::int8_t,
    std::conditional_t<sizeof(T) == 2, std::int16_t, std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>>>;

template <class T>
struct Lanes {
  typedef T Part __attribute__((vector_size(kPartBytes)));  // NOLINT(modernize-use-using): its size depends on T
  static constexpr int kPerPart = kPartBytes / static_cast<int>(sizeof(T));
  Part part[kParts];

  Lanes() = default;
  /// The same number in all lanes.
  HWY_INLINE Lanes(T value) { part[kParts - 1] = part[0] = value - Part{}; }  // NOLINT: as with the compilers' vectors
  HWY_INLINE T operator[](int lane) const { return part[lane / kPerPart][lane % kPerPart]; }
  HWY_INLINE void set(int lane, T value) { part[lane / kPerPart][lane % kPerPart] = value; }
  /// The same bits as lanes of another type.
  template <class To>
  HWY_INLINE Lanes<To> as() const {
    return each<To>([](const Part& x) HWY_ATTR { return typename Lanes<To>::Part(x); }, *this);
  }
  /// Calls `f` with the parts of vectors, one after the other.
  template <class To, class F, class... Vectors>
  static HWY_INLINE Lanes<To> each(const F& f, const Vectors&... vectors) {
    Lanes<To> result;
    result.part[0] = f(vectors.part[0]...);
    if constexpr (kParts == 2) result.part[1] = f(vectors.part[1]...);
    return result;
  }

#define MOTORCADE_OPERATOR(op, Result)                                                                                 \
  friend HWY_INLINE Lanes<Result> operator op(const Lanes& a, const Lanes& b) {                                        \
    return each<Result>([](const Part& x, const Part& y) HWY_ATTR { return typename Lanes<Result>::Part(x op y); }, a, \
                        b);                                                                                            \
  }
#define MOTORCADE_OPERATORS(op) \
  MOTORCADE_OPERATOR(op, T)     \
  friend HWY_INLINE Lanes& operator op##=(Lanes& a, const Lanes& b) { return a = a op b; }
  MOTORCADE_OPERATORS(+)
  MOTORCADE_OPERATORS(-)
  MOTORCADE_OPERATORS(*)
  MOTORCADE_OPERATORS(/)
  MOTORCADE_OPERATORS(&)
  MOTORCADE_OPERATORS(|)
  MOTORCADE_OPERATORS(^)
  MOTORCADE_OPERATOR(<, MaskOf<T>)
  MOTORCADE_OPERATOR(<=, MaskOf<T>)
  MOTORCADE_OPERATOR(>, MaskOf<T>)
  MOTORCADE_OPERATOR(>=, MaskOf<T>)
  MOTORCADE_OPERATOR(==, MaskOf<T>)
  MOTORCADE_OPERATOR(!=, MaskOf<T>)
#undef MOTORCADE_OPERATORS
#undef MOTORCADE_OPERATOR
  friend HWY_INLINE Lanes operator-(const Lanes& a) {
    return each<T>([](const Part& x) HWY_ATTR { return Part(-x); }, a);
  }
  friend HWY_INLINE Lanes operator~(const Lanes& a) {
    return each<T>([](const Part& x) HWY_ATTR { return Part(~x); }, a);
  }
  friend HWY_INLINE Lanes operator<<(const Lanes& a, int bits) {
    return each<T>([bits](const Part& x) HWY_ATTR { return Part(x << static_cast<T>(bits)); }, a);
  }
  friend HWY_INLINE Lanes operator>>(const Lanes& a, int bits) {
    return each<T>([bits](const Part& x) HWY_ATTR { return Part(x >> static_cast<T>(bits)); }, a);
  }
  /// Takes each lane of `a` where the mask is set, and of `b` elsewhere.
  friend HWY_INLINE Lanes choose(const Lanes<MaskOf<T>>& mask, const Lanes& a, const Lanes& b) {
    return each<T>([](const auto& m, const Part& x, const Part& y) HWY_ATTR { return Part(m ? x : y); }, mask, a, b);
  }
  /// Single instructions; the second number where one is none.
  friend HWY_INLINE Lanes lesser(const Lanes& a, const Lanes& b) {
    return each<T>([](const Part& x, const Part& y) HWY_ATTR { return Part(x < y ? x : y); }, a, b);
  }
  friend HWY_INLINE Lanes greater(const Lanes& a, const Lanes& b) {
    return each<T>([](const Part& x, const Part& y) HWY_ATTR { return Part(x > y ? x : y); }, a, b);
  }
};

// Without the C library's checks of where arrays end, which would be calls.
template <class T>
HWY_INLINE Lanes<T> load(const T* from) {
  Lanes<T> lanes;
  __builtin_memcpy(&lanes.part[0], from, kPartBytes);
  if constexpr (kParts == 2) __builtin_memcpy(&lanes.part[1], from + Lanes<T>::kPerPart, kPartBytes);
  return lanes;
}
template <class T>
HWY_INLINE void store(T* to, const std::type_identity_t<Lanes<T>>& lanes) {
  __builtin_memcpy(to, &lanes.part[0], kPartBytes);
  if constexpr (kParts == 2) __builtin_memcpy(to + Lanes<T>::kPerPart, &lanes.part[1], kPartBytes);
}

using Doubles = Lanes<double>;
using Floats = Lanes<float>;
using FloatMask = Lanes<std::int32_t>;

HWY_INLINE Doubles squareRoots(const Doubles& x) {
  return Doubles::each<double>(
      [](const Doubles::Part& part) HWY_ATTR {
        Doubles::Part roots;
        for (int i = 0; i < Doubles::kPerPart; ++i) roots[i] = __builtin_sqrt(part[i]);
        return roots;
      },
      x);
}
HWY_INLINE double total(const Doubles& x) { return (x[0] + x[1]) + (x[2] + x[3]); }

/// A bit for each lane, that of the first one being the lowest.
HWY_INLINE unsigned bitsOf(const FloatMask& mask) {
  unsigned bits = 0;
  for (int i = 0; i < kParts; ++i) {
#if HWY_TARGET <= HWY_AVX2
    bits = static_cast<unsigned>(_mm256_movemask_ps(__m256(mask.part[i])));
#elif HWY_ARCH_X86
    bits |= static_cast<unsigned>(_mm_movemask_ps(__m128(mask.part[i]))) << 4 * i;
#else
    const auto one = mask.part[i] & FloatMask::Part{1, 2, 4, 8};
    bits |= static_cast<unsigned>(vaddvq_s32(int32x4_t(one))) << 4 * i;
#endif
  }
  return bits;
}
HWY_INLINE bool anyOf(const FloatMask& mask) { return bitsOf(mask) != 0; }

}  // namespace motorcade::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
