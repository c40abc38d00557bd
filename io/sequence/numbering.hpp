#pragma once

#include "io/sequence/pairing.hpp"
#include "io/sequence/sequence.hpp"

namespace motorcade {

/// Puts pairs into a sequence, in the order of their numbers. Where most numbers have one step, a number that both
/// sides lack is a frame without images, up to a hundred in a row; beyond that, time alone passes. Times become the
/// frames' stamps.
void setPairs(Sequence& sequence, PairedImages paired);

/// Takes out the frames that both sides lack, as other times than the numbers show that nothing is missing.
void closeNumbers(Sequence& sequence);

}  // namespace motorcade
