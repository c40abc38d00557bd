#pragma once

#include <cstdint>

#include "backend/elimination/clique.hpp"

namespace motorcade {

/// Cost of work on cliques, known before it is done. Flops are floating-point operations of an elimination; memory
/// traffic and bookkeeping count as the operations that take the same time.
struct CliqueCost {
  std::int64_t scalars = 0;  // eliminated
  double flops = 0;

  CliqueCost& operator+=(const CliqueCost& other) {
    scalars += other.scalars;
    flops += other.flops;
    return *this;
  }
};

/// Cost of eliminating a clique anew, without a solution.
CliqueCost eliminationCost(const Clique& clique);
/// Flops of substitution in a clique: of a solution with the comparison of its models, or of a new right-hand side.
double substitutionFlops(const Clique& clique);
/// Cost of moving a variable of so many scalars through a clique; its scalars count as if they were eliminated.
CliqueCost liftCost(const Clique& clique, int variable_scalars);
/// Flops of a variable's share in ordering and laying out cliques, and of a factor's linearization.
constexpr double kFlopsPerOrdered = 1e5, kFlopsPerLinearized = 1e5;

}  // namespace motorcade
