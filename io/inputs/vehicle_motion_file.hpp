#pragma once

#include <filesystem>
#include <vector>

#include "core/vehicle_motion.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// The name of a drive's file of the vehicle's own motion. It is read without an option.
inline constexpr const char* kVehicleMotionFile = "motion.csv";

/// Samples of the vehicle's own motion on the clock of a drive's images, ordered by time. `file` is a table whose
/// header begins with `time_s,speed_mps,yaw_rate_radps`, with optional columns `speed_sigma_mps` and
/// `yaw_rate_sigma_radps`. It may also be KITTI's packets (`oxts.txt` or a folder of them): their speed ahead and rate
/// about the upward axis are taken. Throws InputError naming file and line, also when no sample is of the images' time.
std::vector<VehicleMotionSample> readVehicleMotion(const std::filesystem::path& file, const Sequence& sequence);

/// Writes such a table, without deviations. Throws OutputError.
void writeVehicleMotion(const std::vector<VehicleMotionSample>& samples, const std::filesystem::path& file);

}  // namespace motorcade
