#pragma once

#include <cstdint>

namespace motorcade {

/// The release of OSI whose messages are written.
struct OsiVersion {
  std::uint32_t major, minor, patch;
};
inline constexpr OsiVersion kOsiVersion{3, 7, 0};
/// The release whose rules the trace files follow: the first with rules for MCAP.
inline constexpr const char* kOsiTraceVersion = "3.8.0";

}  // namespace motorcade
