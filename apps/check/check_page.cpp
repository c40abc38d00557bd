#include "apps/check/check_page.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "apps/canvas/color.hpp"
#include "apps/check/finding_guide.hpp"
#include "apps/html/html_page.hpp"

namespace motorcade {
namespace {

constexpr int kJpegQuality = 86;

/// Rounded for reading; a dash where there is no number.
std::string number(double value, const char* pattern = "{:.2f}") {
  if (!std::isfinite(value)) return "–";
  const std::string text = fmt::format(fmt::runtime(pattern), value);
  return text.starts_with("-") && text.find_first_of("123456789") == std::string::npos ? text.substr(1) : text;
}

std::string badge(const char* kind, const char* word) {
  return std::string("<span class=\"badge ") + kind + "\">" + word + "</span>";
}

std::string card(const std::string& value, const std::string& label) {
  return "<div class=\"card\"><div class=\"value\">" + value + "</div><div class=\"label\">" + label + "</div></div>\n";
}

std::string figure(const RgbImage& image, const std::string& alternative, const std::string& caption) {
  std::string html = "<figure><div class=\"wide\"><img src=\"" + dataUri("image/jpeg", encodeJpeg(image, kJpegQuality));
  html += "\" width=\"" + std::to_string(image.width) + "\" height=\"" + std::to_string(image.height);
  return html + "\" alt=\"" + escaped(alternative) + "\"></div><figcaption>" + caption + "</figcaption></figure>\n";
}

std::string row(const std::string& head, std::initializer_list<std::string> numbers) {
  std::string html = "<tr><th scope=\"row\">" + head + "</th>";
  for (const std::string& text : numbers) html += "<td class=\"number\">" + text + "</td>";
  return html + "</tr>\n";
}

std::string headOf(const CheckedInput& input) {
  std::string html = "<h1>Input check ";
  html += isWorthless(input.findings) ? badge("bad", "results would be worthless")
          : input.findings.empty()    ? badge("good", "nothing is wrong")
                                      : badge("warn", "usable, with warnings");
  html += "</h1>\n<p class=\"muted\">" + escaped(input.sequence) + "</p>\n<p>" +
          escaped("motorcade " + verdictOnRun(input.findings)) + ".</p>\n";
  const PairGeometry geometry = input.check->geometry();
  const auto matches = input.check->matches();
  const auto ahead =
      std::ranges::count_if(matches, [](const EpipolarMatch& match) { return match.disparity_px() > 0; });
  const double share = static_cast<double>(ahead) / static_cast<double>(std::max<std::size_t>(1, matches.size()));
  html += "<div class=\"cards\">\n" + card(std::to_string(input.check->pairs()), "pairs looked at") +
          card(std::to_string(matches.size()), "points seen in both images") +
          card(number(geometry.rms_px) + " px", "difference of their rows, root mean square") +
          card(number(geometry.remaining_px) + " px", "left of it once the errors below are taken out") +
          card(number(100 * share, "{:.0f} %"), "of the points lie ahead of the camera") + "</div>\n";
  return html;
}

/// The measured part of a finding's text. The advice behind it is left to the guide, which gives it at more length.
/// Advice on a calibration tells which of its numbers is meant, and stays.
std::string measuredText(const Finding& finding) {
  std::string_view text = finding.text;
  if (finding.name != "calibration") text = text.substr(0, text.rfind("; "));
  std::string shown;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool sign = text.substr(i).starts_with("+-");
    shown += sign ? "±" : std::string(1, text[i]);
    if (sign) ++i;
  }
  return shown;
}

std::string findingsOf(const CheckedInput& input) {
  std::string html = "<h2>What was found</h2>\n";
  if (input.findings.empty())
    html +=
        "<div class=\"finding good\"><p>Nothing is wrong with rows, distortion, order, light, sharpness and times "
        "of these pairs, as far as they tell. What was measured stands below.</p></div>\n";
  for (const Finding& finding : input.findings) {
    const FindingGuide guide = guideTo(finding.name);
    html += std::string("<div class=\"finding ") + (finding.worthless ? "bad" : "warn") + "\">\n<h3>";
    html += escaped(guide.title) + " " + (finding.worthless ? badge("bad", "worthless") : badge("warn", "warning"));
    html += "</h3>\n<p><b>Measured</b> " + escaped(measuredText(finding)) + ".</p>\n<p><b>Means</b> " +
            escaped(guide.meaning) + "</p>\n<p><b>Mend</b> " + escaped(guide.mend) + "</p>\n</div>\n";
  }
  return html;
}

std::string picturesOf(const CheckedInput& input) {
  if (input.worst.empty())
    return "<h2>Pairs</h2>\n<p>No pair has points that were seen in both images: there is nothing to show. Are these "
           "images of one rig, in the right order, and not black?</p>\n";
  std::string html =
      "<h2>The pairs whose rows agree least</h2>\n<p>Lines follow the rows from points of the left "
      "image. In a rectified pair each line ends at the same point of the right image.</p>\n";
  for (const MatchedPair& pair : input.worst) {
    const std::string frame = std::to_string(pair.frame.value);
    html += figure(drawEpipolarLines(pair), "left and right image of frame " + frame + " with lines along their rows",
                   "Frame " + frame + ": rows of " + std::to_string(pair.matches.size()) + " points differ by " +
                       number(rowRms_px(pair.matches)) + " px (root mean square).");
  }
  html += "<h2>Row errors across the image</h2>\n";
  html += figure(drawRowErrors(input.worst.front().left, input.check->matches(), input.check->geometry(), input.camera),
                 "left image with arrows that show the row errors",
                 "Thin bars: what each point of all pairs says. Arrows: what the errors in the table below make of the "
                 "rows, at the usual disparity; downwards where the right image's content lies lower. An offset shows "
                 "as equal arrows, a roll as arrows that change from left to right.");
  return html;
}

std::string verdict(const CheckedInput& input, const RowErrorName& name) {
  const auto found = std::ranges::find(input.findings, name.finding, &Finding::name);
  if (found == input.findings.end()) return badge("good", "good");
  return found->worthless ? badge("bad", "worthless") : badge("warn", "warning");
}

std::string geometryOf(const CheckedInput& input) {
  const PairGeometry geometry = input.check->geometry();
  std::string html =
      "<h2>Rows of left and right image</h2>\n<div class=\"wide\"><table>\n<thead><tr><th></th>"
      "<th class=\"number\">measured</th><th class=\"number\">± sigma</th><th class=\"number\">effect "
      "[px]</th><th></th></tr></thead>\n<tbody>\n";
  for (std::size_t k = 0; k < kRowErrors; ++k) {
    const RowErrorName& name = kRowErrorNames[k];
    const RowErrorEstimate& error = geometry.errors[k];
    html += std::string("<tr><th scope=\"row\">") + name.title + "<div class=\"muted small\">" + name.meaning +
            "</div></th><td class=\"number\">" + number(name.unit * error.value, "{:.3f}") +
            "</td><td class=\"number\">" + number(name.unit * error.sigma, "{:.3f}") + "</td><td class=\"number\">" +
            number(error.effect_px) + "</td><td>" + verdict(input, name) + "</td></tr>\n";
  }
  html +=
      "</tbody></table></div>\n<p class=\"muted small\">Effect: on the rows, root mean square over the image; of the "
      "distortion, the displacement in a corner. " +
      number(100 * geometry.agreeing_share, "{:.0f}") + " % of the points follow these errors to " +
      number(geometry.remaining_px) + " px. What the points do not show stays at zero with a large sigma.</p>\n";
  return html;
}

std::string restOf(const CheckedInput& input) {
  const LightMeasures light = input.check->light();
  const TimeMeasures times = input.check->times();
  const StereoCamera& camera = input.camera;
  std::string html = "<h2>Light, sharpness, times</h2>\n<div class=\"wide\"><table>\n<tbody>\n";
  html +=
      row("mean gray level, left and right", {number(light.left_level, "{:.0f}"), number(light.right_level, "{:.0f}")});
  html += row("grain, left and right [gray levels]", {number(light.left_grain), number(light.right_grain)});
  html += row("largest ratio of brightness, pair to pair and left to right",
              {number(light.jump, "{:.2f}×"), number(light.sides, "{:.2f}×")});
  html += row("seconds between pairs, usual and longest",
              {number(times.usual_s, "{:.4g}"), number(times.most_s, "{:.4g}")});
  html += "</tbody></table></div>\n<h2>Calibration as read</h2>\n<div class=\"wide\"><table>\n<tbody>\n";
  html += row("image size [px]", {std::to_string(camera.width_px), std::to_string(camera.height_px)});
  html += row("focal length fx, fy [px]", {number(camera.fx_px, "{:.6g}"), number(camera.fy_px, "{:.6g}")});
  html += row("principal point cx, cy [px]", {number(camera.cx_px, "{:.6g}"), number(camera.cy_px, "{:.6g}")});
  html += row("baseline [m]", {number(camera.baseline_m, "{:.5g}"), ""});
  return html + "</tbody></table></div>\n";
}

constexpr std::string_view kStyle = R"css(
h1 .badge { vertical-align: middle; margin-left: 0.4rem; white-space: normal; }
.finding h3 { margin-top: 0; }
.small { font-size: 0.84rem; font-weight: 400; }
p.small { margin-top: 0.6rem; }
.wide tbody th { min-width: 9rem; }
figure .wide img { min-width: min(44rem, 100%); }
@media (max-width: 40rem) { figure .wide img { max-width: none; width: 56rem; } }
)css";

}  // namespace

std::string checkPage(const CheckedInput& input) {
  const std::string body =
      headOf(input) + findingsOf(input) + picturesOf(input) + geometryOf(input) + restOf(input) +
      "<p class=\"muted small\">Written by <code>motorcade check --page</code>. It looks at the first " +
      std::to_string(InputCheck::kPairs) +
      " pairs in which something is seen; what is wrong later is told by <code>motorcade run</code>.</p>\n";
  return htmlPage("Input check: " + input.sequence, body, kStyle);
}

}  // namespace motorcade
