#pragma once

#include <filesystem>

#include "apps/draw/image_view.hpp"
#include "io/inputs/pair_reader.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// Reads the left image of a frame, and the mask where the run wrote masks. Throws InputError naming the file.
DrawnImages readDrawnImages(const Sequence& sequence, std::size_t frame, const std::filesystem::path& run_folder,
                            PairReader& reader);

}  // namespace motorcade
