#pragma once

#include <optional>
#include <string>

#include "io/sequence/sequence.hpp"

namespace motorcade {

/// A sentence if a sequence's gray images look like a color sensor's mosaic and are not declared as one. It looks at
/// the files, before any rectification, of up to `pairs` of the first twenty pairs. All of them must look so. Empty for
/// a stream.
std::optional<std::string> mosaicDoubt(const Sequence& sequence, const FrameRange& selected, std::size_t pairs);

}  // namespace motorcade
