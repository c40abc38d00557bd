#pragma once

#include <string>

#include "apps/report/reported_run.hpp"

/// The parts of a report, as HTML that goes into a page's body; empty where there is nothing to tell.
namespace motorcade {

/// What was run, how far, and the figures that matter first.
std::string runSection(const ReportedRun& reported);
/// The drive from above, and each object's speed with its uncertainty.
std::string driveSection(const ReportedRun& reported);
/// How far the camera was from the truth over time, and the tables of `evaluate`.
std::string accuracySection(const ReportedRun& reported);
/// A few annotated frames.
std::string pictureSection(const ReportedRun& reported);
/// How long results took, and where in the pipeline.
std::string latencySection(const ReportedRun& reported);
/// Every parameter in force, and what the program was made of.
std::string settingsSection(const ReportedRun& reported);

}  // namespace motorcade
