#pragma once

#include <string>

// The kernels' vectors have the width of AVX2's, and few processors have SSSE3 without SSE4.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | (HWY_AVX2 - 1))
#include <hwy/targets.h>

namespace motorcade {

/// Instructions that the kernels use, as Highway names them: the best for which they are compiled and that the
/// processor has. With MOTORCADE_INSTRUCTIONS the environment chooses lesser ones, `any` the least. Results are the
/// same. Throws for a name that is not known.
std::string instructionSet();

/// Makes Highway's choice before the first kernel is called.
void chooseInstructions();
inline hwy::ChosenTarget& chosenInstructions() {
  hwy::ChosenTarget& chosen = hwy::GetChosenTarget();
  if (!chosen.IsInitialized()) [[unlikely]]
    chooseInstructions();
  return chosen;
}

}  // namespace motorcade

/// A function of Highway's namespaces, after HWY_EXPORT, in the version of the chosen instructions.
#if (HWY_TARGETS & (HWY_TARGETS - 1)) == 0
#define MOTORCADE_KERNEL(function) HWY_STATIC_DISPATCH(function)
#else
#define MOTORCADE_KERNEL(function) (*HWY_DISPATCH_TABLE(function)[motorcade::chosenInstructions().GetIndex()])
#endif
