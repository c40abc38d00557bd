#pragma once

#include <array>
#include <map>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "apps/evaluate/measures/belief_measures.hpp"
#include "apps/evaluate/measures/covariance_measures.hpp"

/// Probabilities of all drives together, as a tenth of one drive has few rows, and covariances compared with the
/// errors.
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

struct ResultTable;

/// The camera's motion over ten frames, its pose since the start, and objects as seen from it.
inline constexpr std::array kCovarianceTitles = {"camera, over ten frames", "camera, since the start", "objects"};
using CovarianceReliability = std::array<AxisReliability, kCovarianceTitles.size()>;

/// Reliability of the covariances of all runs with one set of parameters.
struct CovarianceReliabilityOfSet {
  CovarianceReliability final, online;
};
using CovarianceReliabilityBySet = std::map<std::string, CovarianceReliabilityOfSet>;

/// Adds an evaluation's counts. The camera's motion includes the truth's noise where it has some. Evaluations of
/// earlier versions have no counts.
void addCovariances(CovarianceReliabilityOfSet& sums, const nlohmann::json& evaluation);

/// A row for each set, estimate and covariance of which there are errors, a column for each axis.
ResultTable covarianceTable(const CovarianceReliabilityBySet& sets);

/// The same as an object for each set, with `final` and `online`: counts by axis, by what they are of.
nlohmann::ordered_json covarianceJson(const CovarianceReliabilityBySet& sets);

/// The same as diagrams for a page, a line for each axis; empty where there are no errors.
std::string covarianceCharts(const CovarianceReliabilityBySet& sets);

}  // namespace motorcade
