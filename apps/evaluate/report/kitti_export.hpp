#pragma once

#include <filesystem>

#include "io/results/run_folder.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// Writes a run's objects as KITTI tracking results for KITTI's own evaluation: `final/data/NAME.txt` and
/// `online/data/NAME.txt` in the folder. NAME is that of the sequence's folder. Other sequences' files stay, so that
/// many runs share one folder. Needs no ground truth. Throws OutputError.
void exportKitti(const std::filesystem::path& folder, const RunFolder& run, const Sequence& sequence);

}  // namespace motorcade
