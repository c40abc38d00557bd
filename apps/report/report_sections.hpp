#pragma once

#include <string>

#include "apps/report/reported_run.hpp"

/// Sections of a report, as HTML for a page's body; empty where there is nothing to tell.
namespace motorcade {

/// The run, its extent, and the most important figures.
std::string runSection(const ReportedRun& reported);
/// The drive from above, and each object's speed with its uncertainty.
std::string driveSection(const ReportedRun& reported);
/// The camera's error over time, and the tables of `evaluate`.
std::string accuracySection(const ReportedRun& reported);
/// A few annotated frames.
std::string pictureSection(const ReportedRun& reported);
/// The latency of results, and its parts in the pipeline.
std::string latencySection(const ReportedRun& reported);
/// Every parameter in force, and the versions of program and libraries.
std::string settingsSection(const ReportedRun& reported);

}  // namespace motorcade
