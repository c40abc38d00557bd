#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace motorcade {

/// Selects the files of a folder to look at: those whose names are usual for a pair's calibration, or all.
enum class RigNames { kUsual, kAny };

/// The files of the calibration in a folder. Their names have `camchain`, `stereo` or `calib` in them; two may have
/// `left` and `right` or `intrinsics` and `extrinsics`, or be cam0/sensor.yaml and cam1/sensor.yaml. Empty where there
/// is none. Throws InputError naming all where several describe different cameras.
std::vector<std::filesystem::path> usualRigFiles(const std::filesystem::path& folder,
                                                 RigNames names = RigNames::kUsual);

/// FILE or LEFT,RIGHT.
std::string joinedFiles(const std::vector<std::filesystem::path>& files);
/// The option --calibration for some files, as a shell takes it.
std::string calibrationArgument(const std::vector<std::filesystem::path>& files);

}  // namespace motorcade
