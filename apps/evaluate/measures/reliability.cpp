#include "apps/evaluate/measures/reliability.hpp"

#include <algorithm>
#include <cmath>

namespace motorcade {
namespace {

constexpr int kLeastRows = 100;  // of a tenth that is judged: the share's own deviation is .05 at most

}  // namespace

void Reliability::add(double probability, bool hit) {
  const auto at = std::min<std::size_t>(tenths.size() - 1, static_cast<std::size_t>(10 * probability));
  ReliabilityTenth& tenth = tenths[at];
  ++tenth.rows;
  tenth.hits += hit;
  tenth.probability_sum += probability;
  const double error = probability - (hit ? 1 : 0);
  squared_error_sum += error * error;
}

int Reliability::rows() const {
  int sum = 0;
  for (const ReliabilityTenth& tenth : tenths) sum += tenth.rows;
  return sum;
}

double Reliability::brier() const { return squared_error_sum / std::max(1, rows()); }

std::optional<double> Reliability::largestGap() const {
  std::optional<double> largest;
  for (const ReliabilityTenth& tenth : tenths)
    if (tenth.rows >= kLeastRows)
      largest = std::max(largest.value_or(0), std::abs(tenth.claimed() - tenth.shareOfHits()));
  return largest;
}

}  // namespace motorcade
