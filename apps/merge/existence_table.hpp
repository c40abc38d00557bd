#pragma once

#include <map>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "apps/evaluate/existence_measures.hpp"

/// Existence probabilities of all drives together: a tenth of one drive has few rows.
namespace motorcade {

struct ResultTable;

/// What the runs with one set of parameters claimed.
struct ExistenceOfSet {
  ExistenceErrors final, online;
};
using ExistenceBySet = std::map<std::string, ExistenceOfSet>;

/// Adds what an evaluation counted; one without labels, or of an earlier version, counted nothing.
void addExistence(ExistenceOfSet& sums, const nlohmann::json& evaluation);

/// A row for each set and estimate that has rows, a column for each tenth in which any has some.
ResultTable existenceTable(const ExistenceBySet& sets);

/// The same as an object for each set, with `final` and `online`.
nlohmann::ordered_json existenceJson(const ExistenceBySet& sets);

}  // namespace motorcade
