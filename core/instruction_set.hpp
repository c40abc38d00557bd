#pragma once

#include <cstddef>

namespace motorcade {

/// The instructions that the kernels use (cmake/kernels.cmake), chosen once, when the program starts: those of
/// x86-64-v3 where the processor has them, unless the environment says MOTORCADE_INSTRUCTIONS=any. Results are the
/// same.
enum class InstructionSet { kAny, kX86V3 };
InstructionSet instructionSet();
const char* nameOf(InstructionSet instructions);

}  // namespace motorcade

/// Called by what tools/dispatch_kernels.sh makes, before other initializers.
extern "C" void motorcade_choose_kernels(void** chosen, void* const* v3, std::size_t count);
