#pragma once

#include <map>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "apps/evaluate/measures/reliability.hpp"

/// Probabilities of all drives together: a tenth of one drive has few rows.
namespace motorcade {

struct ResultTable;

/// A probability of rows that evaluations count by its tenths.
struct Claim {
  const char* title;
  std::string_view path;  // JSON pointer below `final` and `online`
  const char* hits;       // the key of what the probability is of
};
/// A row is there, and it is of the kind that it names.
inline constexpr Claim kExistenceClaim{"Existence: share that is real", "/existence", "real"};
inline constexpr Claim kKindClaim{"Kinds named to 30 m from a track's tenth row on: share that is right",
                                  "/kinds_within_30m/from_tenth_row/named", "right"};

/// Reliability of all runs with one set of parameters.
struct ReliabilityOfSet {
  Reliability final, online;
};
using ReliabilityBySet = std::map<std::string, ReliabilityOfSet>;

/// Adds an evaluation's counts; one without labels, or of an earlier version, has none.
void addReliability(ReliabilityOfSet& sums, const Claim& claim, const nlohmann::json& evaluation);

/// A row for each set and estimate that has rows, a column for each tenth in which any has some.
ResultTable reliabilityTable(const Claim& claim, const ReliabilityBySet& sets);

/// The same as an object for each set, with `final` and `online`.
nlohmann::ordered_json reliabilityJson(const Claim& claim, const ReliabilityBySet& sets);

}  // namespace motorcade
