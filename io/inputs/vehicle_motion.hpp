#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "core/vehicle_motion.hpp"
#include "io/inputs/pair_source.hpp"
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

/// The pairs of another source, each with the samples of the vehicle's own motion up to its time, as sensors would have
/// sent them during the drive.
class VehicleMotionSource final : public ForwardingSource {
 public:
  /// `samples` are ordered by time.
  VehicleMotionSource(std::unique_ptr<PairSource> pairs, std::vector<VehicleMotionSample> samples);

  std::optional<StereoFrame> next() override;

 private:
  std::vector<VehicleMotionSample> samples_;
  std::size_t next_ = 0;  // of the samples
  std::shared_ptr<VehicleMotionLog> log_;
};

}  // namespace motorcade
