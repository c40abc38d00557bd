#include "backend/elimination/clique_cost.hpp"

namespace motorcade {
namespace {

// Measured on torus3D with AVX-512, where 92 operations take a nanosecond: an elimination takes 0.011 ns for each, 0.5
// ns per number of its front, and 0.6 us beside. Most are within 30 % of that.
constexpr double kFlopsPerEntry = 45, kFlopsPerClique = 55e3;
constexpr double kFlopsPerSubstituted = 45, kFlopsPerSolution = 50e3, kFlopsPerCompared = 1e4;  // the last: a factor
constexpr double kFlopsPerLift = 150e3;
/// Flops per number of a panel and of an update matrix that a lift changes: of the copy, and of each of the variable's
/// scalars.
constexpr double kFlopsPerMoved = 40, kFlopsPerReflected = 13, kFlopsPerCopied = 25, kFlopsPerAdded = 6;

}  // namespace

CliqueCost eliminationCost(const Clique& clique) {
  const double n = clique.frontal_size, m = clique.separatorSize() + 1, size = clique.size + 1;
  const double operations = n * n * n / 3 + n * n * m + n * m * m;
  return {clique.frontal_size, operations + kFlopsPerEntry * (n * size + m * m) + kFlopsPerClique};
}

double substitutionFlops(const Clique& clique) {
  return kFlopsPerSubstituted * clique.frontal_size * clique.size + kFlopsPerSolution +
         kFlopsPerCompared * static_cast<double>(clique.factors.size());
}

CliqueCost liftCost(const Clique& clique, int variable_scalars) {
  const double m = clique.separatorSize(), of_panel = static_cast<double>(clique.frontal_size) * clique.size;
  return {clique.frontal_size, of_panel * (kFlopsPerMoved + kFlopsPerReflected * variable_scalars) +
                                   m * m / 2 * (kFlopsPerCopied + kFlopsPerAdded * variable_scalars) + kFlopsPerLift};
}

}  // namespace motorcade
