#include <algorithm>

#include "apps/evaluate/comparison/trajectory_error.hpp"
#include "apps/evaluate/report/report.hpp"
#include "apps/html/html_page.hpp"
#include "apps/html/svg_chart.hpp"
#include "apps/report/report_sections.hpp"

namespace motorcade {
namespace {

/// Distances of positions after SE(3) alignment, over time.
ChartLine errorsOf(const char* name, const char* color, std::vector<SE3> path, const RecordedDrive& drive) {
  ChartLine line{.name = name, .color = color};
  const std::size_t count = std::min({path.size(), drive.T_world_cam_true.size(), drive.stamps.size()});
  path.resize(count);
  const std::vector<SE3> truth(drive.T_world_cam_true.begin(),
                               drive.T_world_cam_true.begin() + static_cast<std::ptrdiff_t>(count));
  const SE3 aligned = alignPositions(path, truth);
  for (std::size_t i = 0; i < count; ++i)
    line.points.emplace_back(secondsBetween(drive.stamps.front(), drive.stamps[i]),
                             ((aligned * path[i]).translation() - truth[i].translation()).norm());
  return line;
}

std::string errorChart(const ReportedRun& reported) {
  const RecordedDrive& drive = reported.drive;
  if (drive.T_world_cam_true.size() < 3) return "";
  std::vector<ChartLine> lines;
  if (!reported.baseline.empty()) lines.push_back(errorsOf("baseline", "var(--ink)", reported.baseline, drive));
  lines.push_back(errorsOf("online", "var(--muted)", reported.run.online.camera, drive));
  lines.push_back(errorsOf("final", "var(--line1)", drive.T_world_cam, drive));
  return chartFigure(lineChart({.x = "s", .y = "camera position error, m", .wide = true}, lines),
                     "How far the camera's path is from the truth, each moved onto it as a whole (SE(3) alignment).");
}

}  // namespace

std::string accuracySection(const ReportedRun& reported) {
  if (!reported.evaluation) return "";
  return "<h2>Accuracy</h2>\n" + errorChart(reported) +
         "<details open><summary>All measures, as motorcade evaluate prints them</summary><pre>" +
         escaped(tableOf(*reported.evaluation)) + "</pre></details>\n";
}

}  // namespace motorcade
