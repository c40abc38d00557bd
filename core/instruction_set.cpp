#include "core/instruction_set.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>

namespace motorcade {
namespace {

// From the least on, as in tables of kernels. Highway takes a processor without any of its targets for one without
// vectors; but x86-64 has SSE2, and arm64 NEON.
#if HWY_ARCH_X86
constexpr std::array kNames{"SSE2", "SSE4", "AVX2", "AVX512"};

int best() {
  __builtin_cpu_init();
  const auto has = [](bool feature, auto... others) { return (feature && ... && others); };
  if (!has(__builtin_cpu_supports("sse4.2") != 0, __builtin_cpu_supports("aes") != 0,
           __builtin_cpu_supports("pclmul") != 0))
    return 0;
  if (!has(__builtin_cpu_supports("avx2") != 0, __builtin_cpu_supports("fma") != 0, __builtin_cpu_supports("bmi") != 0,
           __builtin_cpu_supports("bmi2") != 0))
    return 1;
  return has(__builtin_cpu_supports("avx512f") != 0, __builtin_cpu_supports("avx512cd") != 0,
             __builtin_cpu_supports("avx512vl") != 0, __builtin_cpu_supports("avx512dq") != 0,
             __builtin_cpu_supports("avx512bw") != 0)
             ? 3
             : 2;
}
#else
constexpr std::array kNames{"NEON"};

int best() { return 0; }
#endif

/// The place of a name; `any` is the least.
int placeOf(const std::string& name) {
  if (name == "any") return 0;
  std::string known = "any";
  for (std::size_t place = 0; place < kNames.size(); ++place) {
    if (name == kNames[place]) return static_cast<int>(place);
    known += std::string(", ") + kNames[place];
  }
  throw std::invalid_argument("MOTORCADE_INSTRUCTIONS=" + name + ": must be one of " + known);
}

}  // namespace

std::atomic<int> chosen_instructions{-1};

void chooseInstructions() {
  const char* const wanted = secure_getenv("MOTORCADE_INSTRUCTIONS");
  chosen_instructions = wanted != nullptr ? std::min(placeOf(wanted), best()) : best();
}

std::string instructionSet() { return kNames[chosenInstructions()]; }

}  // namespace motorcade
