#include "apps/html/html_page.hpp"

#include <algorithm>
#include <cstdint>

namespace motorcade {
namespace {

constexpr std::string_view kBaseStyle = R"css(
:root {
  color-scheme: light dark;
  --page: #f6f7f8; --ink: #1a2027; --muted: #5b6672; --rule: #d9dee3; --card: #ffffff;
  --accent: #0b62c4; --good: #17713a; --warn: #8f5a00; --bad: #b3261e;
}
@media (prefers-color-scheme: dark) {
  :root {
    --page: #11151b; --ink: #e4e9ee; --muted: #97a3b0; --rule: #2c343e; --card: #191f27;
    --accent: #6cb2ff; --good: #63c98a; --warn: #f0b450; --bad: #ff8a80;
  }
}
@media print {
  :root {
    color-scheme: light;
    --page: #ffffff; --ink: #000000; --muted: #444444; --rule: #bbbbbb; --card: #ffffff;
    --accent: #0b4ea2; --good: #17713a; --warn: #7a4d00; --bad: #a01f18;
  }
}
*, *::before, *::after { box-sizing: border-box; }
html { -webkit-text-size-adjust: 100%; text-size-adjust: 100%; }
body {
  --under: var(--page); --edge: color-mix(in srgb, var(--ink) 20%, transparent);
  margin: 0; background: var(--page); color: var(--ink);
  font: 16px/1.55 system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", "DejaVu Sans", sans-serif;
  -webkit-print-color-adjust: exact; print-color-adjust: exact;
}
main { max-width: 70rem; margin: 0 auto; padding: 2.5rem 1.5rem 4rem; }
h1 { font-size: 1.75rem; line-height: 1.2; letter-spacing: -0.01em; margin: 0 0 0.3rem; text-wrap: balance; }
h2 { font-size: 1.2rem; line-height: 1.3; margin: 2.6rem 0 0.8rem; break-after: avoid; }
h3 { font-size: 1rem; margin: 1.6rem 0 0.4rem; break-after: avoid; }
p { margin: 0 0 0.9rem; max-width: 46rem; }
h1, h2, h3, p, td, figcaption { overflow-wrap: anywhere; }
a { color: var(--accent); }
code, pre, kbd { font: 0.9em/1.5 ui-monospace, SFMono-Regular, Menlo, "DejaVu Sans Mono", monospace; }
code { background: color-mix(in srgb, var(--muted) 14%, transparent); padding: 0.08em 0.32em; border-radius: 4px; }
pre { overflow-x: auto; padding: 0.8rem 1rem; background: var(--card); border: 1px solid var(--rule);
  border-radius: 8px; }
pre code { background: none; padding: 0; }
hr { border: 0; border-top: 1px solid var(--rule); margin: 2rem 0; }
table { border-collapse: collapse; width: 100%; font-size: 0.92rem; line-height: 1.4; }
caption { text-align: left; color: var(--muted); padding-bottom: 0.5rem; }
th, td { padding: 0.42rem 0.75rem; text-align: left; vertical-align: baseline;
  border-bottom: 1px solid var(--rule); }
th:first-child, td:first-child { padding-left: 0.2rem; }
th:last-child, td:last-child { padding-right: 0.2rem; }
thead th { color: var(--muted); font-weight: 600; font-size: 0.84rem; border-bottom-width: 2px; }
tbody th { font-weight: 500; }
.number { text-align: right; font-variant-numeric: tabular-nums; white-space: nowrap; }
/* A shadow at each edge beyond which there is more: its cover scrolls with the content, and lies on it at the end. */
.wide { overflow-x: auto; -webkit-overflow-scrolling: touch; background:
  linear-gradient(to right, var(--under) 40%, transparent) left / 3rem 100% no-repeat local,
  linear-gradient(to left, var(--under) 40%, transparent) right / 3rem 100% no-repeat local,
  linear-gradient(to right, var(--edge), transparent) left / 1rem 100% no-repeat scroll,
  linear-gradient(to left, var(--edge), transparent) right / 1rem 100% no-repeat scroll; }
.swipe { display: none; font-size: 0.84rem; color: var(--muted); margin: 0.4rem 0 0; }
@media (max-width: 44rem) { .swipe { display: block; } }
@media print { .wide { background: none; } .swipe { display: none; } }
.muted { color: var(--muted); }
figure { margin: 1.4rem 0; break-inside: avoid; }
figure img, figure svg { display: block; max-width: 100%; height: auto; border-radius: 8px; }
figcaption { color: var(--muted); font-size: 0.9rem; margin-top: 0.5rem; max-width: 46rem; }
.cards { display: grid; gap: 0.8rem; grid-template-columns: repeat(auto-fit, minmax(9.5rem, 1fr));
  margin: 1.4rem 0; }
.card { background: var(--card); border: 1px solid var(--rule); border-radius: 10px; padding: 0.8rem 1rem;
  break-inside: avoid; }
.card .value { font-size: 1.5rem; line-height: 1.25; font-weight: 600; font-variant-numeric: tabular-nums; }
.card .label { color: var(--muted); font-size: 0.86rem; }
.badge { display: inline-block; padding: 0.1em 0.6em; border-radius: 999px; font-size: 0.78rem; font-weight: 600;
  color: var(--muted); background: color-mix(in srgb, currentColor 14%, transparent); white-space: nowrap; }
.badge.good { color: var(--good); } .badge.warn { color: var(--warn); } .badge.bad { color: var(--bad); }
.finding { background: var(--card); border: 1px solid var(--rule); border-left: 4px solid var(--muted);
  border-radius: 8px; padding: 0.85rem 1.1rem; margin: 0 0 0.8rem; break-inside: avoid; }
.finding.good { border-left-color: var(--good); } .finding.warn { border-left-color: var(--warn); }
.finding.bad { border-left-color: var(--bad); }
.finding > :last-child { margin-bottom: 0; }
.keep { break-inside: avoid; }
@media (max-width: 40rem) {
  main { padding: 1.4rem 1rem 3rem; }
  h1 { font-size: 1.4rem; }
  h2 { margin-top: 2rem; }
  th, td { padding: 0.36rem 0.5rem; }
  .cards { grid-template-columns: repeat(2, minmax(0, 1fr)); gap: 0.6rem; }
  .card { padding: 0.6rem 0.75rem; }
  .card .value { font-size: 1.2rem; }
}
@media print {
  body { font-size: 10.5pt; }
  main { max-width: none; padding: 0; }
  tr { break-inside: avoid; }
  a { color: inherit; text-decoration: none; }
}
)css";

constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

}  // namespace

std::string escaped(std::string_view text) {
  std::string safe;
  safe.reserve(text.size());
  for (const char letter : text) {
    const bool control =
        (static_cast<unsigned char>(letter) < 0x20 && letter != '\n' && letter != '\t') || letter == 0x7F;
    switch (letter) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      case '\'':
        safe += "&#39;";
        break;
      default:
        control ? safe += "\xEF\xBF\xBD" : safe += letter;
    }
  }
  return safe;
}

std::string base64(std::string_view bytes) {
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t count = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t bits = 0;
    for (std::size_t k = 0; k < 3; ++k) bits = bits << 8 | (k < count ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[bits >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

std::string base64(std::span<const std::byte> bytes) {
  return base64(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

std::string dataUri(std::string_view mime, std::string_view bytes) {
  return "data:" + std::string(mime) + ";base64," + base64(bytes);
}

std::string htmlPage(std::string_view title, std::string_view body, std::string_view extra_style) {
  std::string page = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  page += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  page += "<title>" + escaped(title) + "</title>\n<style>";
  page += kBaseStyle;
  page += extra_style;
  page += "</style>\n</head>\n<body>\n<main>\n";
  page += body;
  page += "\n</main>\n</body>\n</html>\n";
  return page;
}

}  // namespace motorcade
