#include "apps/report/report_command.hpp"

#include <iostream>

#include "apps/console/log.hpp"
#include "apps/html/html_page.hpp"
#include "apps/report/report_sections.hpp"
#include "io/line_file.hpp"

namespace motorcade {
namespace {

constexpr std::string_view kStyle = R"css(
:root {
  --line1: #0b62c4; --line2: #c2410c; --truth: #4b5563; --s1: #2f6fb7; --s2: #69a5dc; --s3: #2a9d8f; --s4: #d9a62e;
  --s5: #b4558a; --s6: #6b5bbf; --s7: #d1663a; --wait: #c3cad2;
}
@media (prefers-color-scheme: dark) {
  :root {
    --line1: #6cb2ff; --line2: #ff9d66; --truth: #b6c0cb; --s1: #4f8fd6; --s2: #8cc3f2; --s3: #4cc0b0; --s4: #e8bf55;
    --s5: #d982b2; --s6: #9a8cec; --s7: #f08d63; --wait: #46505c;
  }
}
@media print {
  :root {
    --line1: #0b4ea2; --line2: #b33c0a; --truth: #444444; --s1: #2f6fb7; --s2: #69a5dc; --s3: #2a9d8f; --s4: #d9a62e;
    --s5: #b4558a; --s6: #6b5bbf; --s7: #d1663a; --wait: #c3cad2;
  }
}
.chart { width: 100%; font-size: 11.5px; } .chart.across { min-width: 40rem; }
@media print { .chart.across { min-width: 0; } }
.chart text { fill: var(--muted); } .chart .mark { fill: var(--ink); paint-order: stroke; stroke: var(--card);
  stroke-width: 4px; stroke-linejoin: round; }
.chart .grid { stroke: var(--rule); stroke-width: 1; } .chart .axis { stroke: var(--muted); stroke-width: 1; }
.chart .line { fill: none; stroke-width: 1.8; stroke-linejoin: round; stroke-linecap: round; }
.chart .dashed { stroke-dasharray: 5 5; stroke-width: 1.5; } .chart .band { opacity: 0.2; }
figure.plate { background: var(--card); border: 1px solid var(--rule); border-radius: 10px; padding: 0.8rem; }
.grid { display: grid; gap: 1rem; grid-template-columns: repeat(auto-fill, minmax(min(100%, 26rem), 1fr)); }
.grid figure { margin: 0; }
@media (min-width: 40.1rem) { .cards { grid-template-columns: repeat(auto-fit, minmax(7.8rem, 1fr)); } }
.card .value { font-size: 1.3rem; white-space: nowrap; }
details { margin: 1rem 0; } summary { cursor: pointer; color: var(--accent); }
details pre { font-size: 0.78rem; max-height: 40rem; }
@media print { details pre { max-height: none; white-space: pre-wrap; font-size: 7pt; } }
)css";

}  // namespace

std::string chartFigure(const std::string& svg, const std::string& caption) {
  return "<figure class=\"plate\">" + svg + "<figcaption>" + escaped(caption) + "</figcaption></figure>\n";
}

int runReport(const ReportOptions& options) {
  const ReportedRun reported = readReportedRun(options);
  std::string body;
  for (const auto section :
       {runSection, driveSection, pictureSection, accuracySection, latencySection, settingsSection})
    body += section(reported);
  const auto file = options.out.empty() ? options.run / "report.html" : options.out;
  writeAtOnce(file, htmlPage("Motorcade: " + reported.drive.name, body, kStyle));
  if (tellsProgress()) std::cout << "report in " << file.string() << '\n';
  return 0;
}

}  // namespace motorcade
