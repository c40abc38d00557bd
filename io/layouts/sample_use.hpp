#pragma once

#include <filesystem>
#include <optional>

#include "io/sequence.hpp"

namespace motorcade {

/// How images with samples of 16 bits become gray, the same way for the whole drive and both sides: told by some pairs
/// all along it, so that a part of the drive gets what the whole gets. Empty where the images have 8 bits.
std::optional<SampleUse> sampleUseOf(const Sequence& sequence);

/// The mosaic that a calibration in YAML tells of, `bayer_pattern: RGGB` of the pair or of `cam0`; mostly none. Throws
/// InputError for no such pattern.
std::optional<BayerPattern> toldMosaic(const std::filesystem::path& calibration);
/// The mosaic that the user gives, else the sequence's own. Throws UsageError for no such pattern, and InputError where
/// an image has colors.
std::optional<BayerPattern> mosaicOf(const Sequence& sequence, const GivenCameras& given);

}  // namespace motorcade
