#pragma once

#include <atomic>
#include <cstddef>
#include <string>

// Most kernels' vectors have the width of AVX2's. A source that gains from AVX-512 defines MOTORCADE_WIDE_KERNELS
// before it includes this. Few processors have SSSE3 without SSE4.
#undef HWY_DISABLED_TARGETS
#ifdef MOTORCADE_WIDE_KERNELS
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | ((HWY_AVX2 - 1) & ~HWY_AVX3))
#else
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | (HWY_AVX2 - 1))
#endif
#include <hwy/detect_targets.h>

namespace motorcade {

/// Instructions that the kernels use: the best for which they are compiled and that the processor has. With
/// MOTORCADE_INSTRUCTIONS the environment chooses lesser ones, `any` the least. Results are the same.
std::string instructionSet();

/// Chooses them, before the first kernel is called or anew. Throws for a name that is not known.
void chooseInstructions();

/// The chosen version's place in tables of MOTORCADE_EXPORT; negative before the choice.
extern std::atomic<int> chosen_instructions;
inline std::size_t chosenInstructions() {
  if (chosen_instructions.load(std::memory_order_relaxed) < 0) [[unlikely]]
    chooseInstructions();
  return static_cast<std::size_t>(chosen_instructions.load(std::memory_order_relaxed));
}

}  // namespace motorcade

/// Table of a function's versions in Highway's namespaces, from the least on, and the chosen one. They replace
/// HWY_EXPORT and HWY_DYNAMIC_DISPATCH, which need Highway's library: it measures clocks whenever it is loaded.
#if HWY_ARCH_X86
#ifdef MOTORCADE_WIDE_KERNELS
#define MOTORCADE_CHOOSE_AVX512(function) HWY_CHOOSE_AVX3(function)
#else
#define MOTORCADE_CHOOSE_AVX512(function) HWY_CHOOSE_AVX2(function)
#endif
#define MOTORCADE_EXPORT(function)                                                        \
  static constexpr decltype(&HWY_STATIC_DISPATCH(function)) function##_versions[] {       \
    &HWY_STATIC_DISPATCH(function), HWY_CHOOSE_SSE4(function), HWY_CHOOSE_AVX2(function), \
        MOTORCADE_CHOOSE_AVX512(function)                                                 \
  }
#else
#define MOTORCADE_EXPORT(function) \
  static constexpr decltype(&HWY_STATIC_DISPATCH(function)) function##_versions[] { &HWY_STATIC_DISPATCH(function) }
#endif
#define MOTORCADE_KERNEL(function) (*function##_versions[motorcade::chosenInstructions()])
