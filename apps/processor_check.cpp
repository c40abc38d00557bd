#include <cstring>

#include <unistd.h>

/// Stops with a clear message, instead of an illegal instruction, on a processor that the rest of the program is not
/// built for. Compiled for any x86-64 and run before every other initializer.
namespace {

[[gnu::constructor(101)]] void checkProcessor() {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("x86-64-v3")) return;
  constexpr int kExitInternal = 70;
  const char* const message =
      "motorcade: this program is built for processors with AVX2 and FMA (x86-64-v3), and this one has not got them.\n"
      "Build it with -DMOTORCADE_PORTABLE=ON to run it here.\n";
  if (write(STDERR_FILENO, message, std::strlen(message)) < 0) _exit(kExitInternal);
  _exit(kExitInternal);
}

}  // namespace
