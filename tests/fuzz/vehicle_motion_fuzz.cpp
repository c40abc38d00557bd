#include <array>
#include <cmath>
#include <limits>

#include "io/inputs/vehicle_motion.hpp"
#include "tests/fuzz/fuzz_input.hpp"

using namespace motorcade;

/// Samples of the vehicle's own motion, as a table or as packets, beside images of one second.
int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::MemoryFile file;
  constexpr std::array<std::string_view, 7> kNoLine{": is empty",         ": begins with '",
                                                    ": has no sample",    ", are not those of",
                                                    ": packet ",          ", whose times are not known",
                                                    " frames, there are "};
  Sequence sequence;
  sequence.stamps = {{0}, {1'000'000'000}};
  const auto& path = file.holding(fuzz::textOf(data, size));
  fuzz::readOrRefuse(path.native(), kNoLine, [&] {
    Timestamp last{std::numeric_limits<std::int64_t>::min()};
    for (const VehicleMotionSample& sample : readVehicleMotion(path, sequence)) {
      fuzz::require(sample.stamp >= last, "samples out of order");
      fuzz::require(std::isfinite(sample.speed_mps) && std::isfinite(sample.yaw_rate_radps), "a motion not finite");
      last = sample.stamp;
    }
  });
  return 0;
}
