#include "apps/evaluate/measures/existence_measures.hpp"

namespace motorcade {

Reliability existenceErrors(const std::vector<ComparedFrame>& frames) {
  Reliability errors;
  for (const ComparedFrame& frame : frames)
    for (const MatchedRow& row : frame.rows)
      if (!row.in_ignored_area)
        errors.add(row.row.object.existence_probability, row.object >= 0 && frame.objects[row.object].ever_moves);
  return errors;
}

}  // namespace motorcade
