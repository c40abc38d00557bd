#include "core/instruction_set.hpp"

#include <cstdlib>
#include <mutex>
#include <stdexcept>
#include <string>

namespace motorcade {
namespace {

/// Highway takes a processor without any of its targets for one without vectors; but x86-64 has SSE2, and arm64 NEON.
std::string nameOf(std::int64_t target) {
  if (target == HWY_SCALAR || target == HWY_EMU128) return HWY_ARCH_X86 ? "SSE2" : "NEON";
  return hwy::TargetName(target);
}

/// Targets that are better than those of a name. Better ones have lower bits.
std::int64_t betterThan(const std::string& name) {
  if (name == "any") return HWY_STATIC_TARGET - 1;
  std::string known = "any";
  for (std::int64_t rest = HWY_TARGETS; rest != 0; rest &= rest - 1) {
    const std::int64_t target = rest & -rest;
    if (name == nameOf(target)) return target - 1;
    known += ", " + nameOf(target);
  }
  throw std::invalid_argument("MOTORCADE_INSTRUCTIONS=" + name + ": must be one of " + known);
}

std::mutex choosing;  // Highway takes no care of several threads

}  // namespace

void chooseInstructions() {
  const std::lock_guard lock(choosing);
  const char* const wanted = secure_getenv("MOTORCADE_INSTRUCTIONS");
  hwy::DisableTargets(wanted != nullptr ? betterThan(wanted) : 0);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

std::string instructionSet() {
  chosenInstructions();
  const std::int64_t targets = (hwy::SupportedTargets() & HWY_TARGETS) | HWY_STATIC_TARGET;
  return nameOf(targets & -targets);
}

}  // namespace motorcade
