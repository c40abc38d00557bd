#include "core/instruction_set.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>

namespace motorcade {
namespace {

#if defined(MOTORCADE_DISPATCH)
InstructionSet suited() {
  __builtin_cpu_init();
  const char* const wanted = secure_getenv("MOTORCADE_INSTRUCTIONS");
  if (wanted != nullptr && std::strcmp(wanted, "any") == 0) return InstructionSet::kAny;
  return __builtin_cpu_supports("x86-64-v3") != 0 ? InstructionSet::kX86V3 : InstructionSet::kAny;
}
#elif defined(__x86_64__)
InstructionSet suited() { return InstructionSet::kX86V3; }
#else
InstructionSet suited() { return InstructionSet::kAny; }
#endif

}  // namespace

InstructionSet instructionSet() { return suited(); }

const char* nameOf(InstructionSet instructions) {
#ifdef __x86_64__
  return instructions == InstructionSet::kX86V3 ? "x86-64-v3" : "x86-64";
#else
  return instructions == InstructionSet::kX86V3 ? "" : "generic";
#endif
}

}  // namespace motorcade

void motorcade_choose_kernels(void** chosen, void* const* v3, std::size_t count) {
  if (motorcade::instructionSet() == motorcade::InstructionSet::kX86V3) std::copy_n(v3, count, chosen);
}
