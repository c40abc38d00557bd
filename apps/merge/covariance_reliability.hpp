#pragma once

#include <array>
#include <map>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "apps/evaluate/measures/axis_reliability.hpp"

/// Covariances of all drives together, by axis, compared with the errors.
namespace motorcade {

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
