#include "io/sequence/timestamps.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace motorcade;

/// Times; between any two the seconds can be told.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::MemoryFile file;
  const auto& path = file.holding(fuzz::textOf(data, size));
  fuzz::readOrRefuse(path.native(), {}, [&] {
    const auto stamps = readTimestamps(path);
    for (std::size_t i = 1; i < stamps.size(); ++i)
      fuzz::require(secondsBetween(stamps[i - 1], stamps[i]) > 0, "times that do not increase");
    if (stamps.size() > 1) fuzz::require(secondsBetween(stamps.front(), stamps.back()) > 0, "times that wrap around");
  });
  return 0;
}
