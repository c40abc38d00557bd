#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "io/images/image_file.hpp"
#include "io/sequence/sequence.hpp"

/// The cameras as the user gives them, and the conversion of their samples to gray.
namespace motorcade {

/// The same with absolute paths, so that it can be used from elsewhere.
GivenCameras absolute(const GivenCameras& given);

/// The camera that the user gives: five numbers, a KITTI calibration (*.txt) or that of a pair that is not rectified,
/// with which the sequence gets its rectification. Throws UsageError or InputError.
StereoCamera givenCamera(Sequence& sequence, const GivenCameras& given, ImageSize size);

/// Chooses how 16-bit samples become gray, for the whole drive and both sides alike. Pairs spread over the drive
/// decide, so that a part of it is converted like the whole. Empty for 8-bit images.
std::optional<SampleUse> sampleUseOf(const Sequence& sequence);

/// The mosaic that a calibration in YAML gives, as `bayer_pattern: RGGB` of the pair or of `cam0`; mostly none. Throws
/// InputError for an unknown pattern.
std::optional<BayerPattern> toldMosaic(const std::filesystem::path& calibration);
/// The mosaic that the user gives, else the sequence's own. Throws UsageError for an unknown pattern, and InputError
/// where an image has colors.
std::optional<BayerPattern> mosaicOf(const Sequence& sequence, const GivenCameras& given);

}  // namespace motorcade
