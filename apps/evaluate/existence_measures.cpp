#include "apps/evaluate/existence_measures.hpp"

#include <algorithm>
#include <cmath>

namespace motorcade {
namespace {

constexpr int kLeastRows = 100;  // of a tenth that is judged: the share's own deviation is .05 at most

void add(ExistenceErrors& errors, double probability, bool real) {
  const auto tenth = std::min<std::size_t>(errors.tenths.size() - 1, static_cast<std::size_t>(10 * probability));
  ExistenceTenth& counts = errors.tenths[tenth];
  ++counts.rows;
  counts.real += real;
  counts.probability_sum += probability;
  const double error = probability - (real ? 1 : 0);
  errors.squared_error_sum += error * error;
}

}  // namespace

int ExistenceErrors::rows() const {
  int sum = 0;
  for (const ExistenceTenth& tenth : tenths) sum += tenth.rows;
  return sum;
}

double ExistenceErrors::brier() const { return squared_error_sum / std::max(1, rows()); }

std::optional<double> ExistenceErrors::largestGap() const {
  std::optional<double> largest;
  for (const ExistenceTenth& tenth : tenths)
    if (tenth.rows >= kLeastRows)
      largest = std::max(largest.value_or(0), std::abs(tenth.claimed() - tenth.shareReal()));
  return largest;
}

ExistenceErrors existenceErrors(const std::vector<ComparedFrame>& frames) {
  ExistenceErrors errors;
  for (const ComparedFrame& frame : frames)
    for (const MatchedRow& row : frame.rows)
      if (!row.in_ignored_area)
        add(errors, row.row.object.existence_probability, row.object >= 0 && frame.objects[row.object].ever_moves);
  return errors;
}

}  // namespace motorcade
