#include "apps/report/report_command.hpp"

#include <iostream>

#include "apps/console/log.hpp"
#include "apps/html/html_page.hpp"
#include "apps/html/svg_chart.hpp"
#include "apps/report/report_sections.hpp"
#include "io/files/line_file.hpp"

namespace motorcade {
namespace {

constexpr std::string_view kStyle = R"css(
.grid { display: grid; gap: 1rem; grid-template-columns: repeat(auto-fill, minmax(min(100%, 26rem), 1fr)); }
.grid figure { margin: 0; }
@media (min-width: 40.1rem) { .cards { grid-template-columns: repeat(auto-fit, minmax(7.8rem, 1fr)); } }
.card .value { font-size: 1.3rem; white-space: nowrap; }
details { margin: 1rem 0; } summary { cursor: pointer; color: var(--accent); }
details pre { font-size: 0.78rem; max-height: 40rem; }
@media print { details pre { max-height: none; white-space: pre-wrap; font-size: 7pt; } }
)css";

}  // namespace

int runReport(const ReportOptions& options) {
  const ReportedRun reported = readReportedRun(options);
  std::string body;
  for (const auto section :
       {runSection, driveSection, pictureSection, accuracySection, latencySection, settingsSection})
    body += section(reported);
  const auto file = options.out.empty() ? options.run / "report.html" : options.out;
  writeAtOnce(file, htmlPage("Motorcade: " + reported.drive.name, body, std::string(kChartStyle).append(kStyle)));
  if (tellsProgress()) std::cout << "report in " << file.string() << '\n';
  return 0;
}

}  // namespace motorcade
