#pragma once

#include "io/sequence/pairing.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// Puts pairs into a sequence, in the order of their numbers. Where most numbers have one step, a number that both
/// sides lack becomes a frame without images, up to a hundred in a row. Longer gaps only take time. Times become the
/// frames' stamps.
void setPairs(Sequence& sequence, PairedImages paired);

/// Removes the frames that both sides lack, when times that do not come from the numbers show that nothing is missing.
void closeNumbers(Sequence& sequence);

}  // namespace motorcade
