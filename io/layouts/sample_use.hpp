#pragma once

#include <optional>

#include "io/sequence.hpp"

namespace motorcade {

/// How images with samples of 16 bits become gray, the same way for the whole drive and both sides: told by some pairs
/// all along it, so that a part of the drive gets what the whole gets. Empty where the images have 8 bits.
std::optional<SampleUse> sampleUseOf(const Sequence& sequence);

/// The mosaic that the user gives. Throws UsageError for no such pattern, and InputError where an image has colors.
std::optional<BayerPattern> givenMosaic(const Sequence& sequence, const GivenCameras& given);

}  // namespace motorcade
