#include "apps/evaluate/table_text.hpp"

namespace motorcade {
namespace {

std::string labelName(const ObjectErrors& object) {
  std::string name;
  print(name, "%-6lld %s", static_cast<long long>(object.label), object.type.c_str());
  return name;
}

void printMotionLine(std::string& text, const std::string& whose, const MotionErrors& m) {
  print(text, "  %-21.21s  %7.3f %7.3f %7.3f %7.3f %7.3f ", whose.c_str(), m.me_m.mean, m.me_m.rmse, m.me_m.median,
        m.me_m.p95, m.me_m.max);
  print(text, " %6.2f %6.2f %6.2f %6.2f %6.2f\n", m.me_deg.mean, m.me_deg.rmse, m.me_deg.median, m.me_deg.p95,
        m.me_deg.max);
}

/// Under the root mean squares, of which it is the mean.
void printObjectRms(std::string& text, const std::string& whose, const ObjectRms& rms) {
  if (rms.objects > 0)
    print(text, "  %-21.21s  %7s %7.3f %24s  %6s %6.2f\n", whose.c_str(), "", rms.me_m, "", "", rms.me_deg);
}

void printLargest(std::string& text, const char* what, const LargestStep& step, const char* unit) {
  if (step.label < 0) return;
  print(text, "  %s %.3f %s: frame %lld, label %lld, track %d\n", what, step.error, unit,
        static_cast<long long>(step.frame.value), static_cast<long long>(step.label),
        static_cast<int>(step.track.value));
}

void printSpeedLine(std::string& text, const std::string& whose, const MotionErrors& m) {
  print(text, "  %-21.21s  %7.2f %+7.2f %7.0f %%\n", whose.c_str(), m.speed_mps.rmse, m.speed_bias_mps,
        100 * m.speed_coverage);
}

}  // namespace

void printMotions(std::string& text, const Evaluation& e) {
  text += "\nmotion of the same         ME_t m                                   ME_r deg\n";
  text += "                            mean    rmse  median     p95     max    mean   rmse median    p95    max\n";
  for (const auto& object : e.final.objects)
    if (object.positions) printMotionLine(text, labelName(object), object.motion);
  printMotionLine(text, "all steps, final", e.final.motion);
  printMotionLine(text, "all steps, online", e.online.motion);
  printObjectRms(text, "objects' mean, final", e.final.motion_rms);
  printObjectRms(text, "objects' mean, online", e.online.motion_rms);
  printLargest(text, "largest, final: ", e.final.motion.largest_m, "m");
  printLargest(text, "largest, online:", e.online.motion.largest_m, "m");
  printLargest(text, "largest, final: ", e.final.motion.largest_deg, "deg");
  printLargest(text, "largest, online:", e.online.motion.largest_deg, "deg");
  text += "\nspeed of the same, m/s       rmse    bias within 95 %\n";
  for (const auto& object : e.final.objects)
    if (object.positions) printSpeedLine(text, labelName(object), object.motion);
  printSpeedLine(text, "all rows, final", e.final.motion);
  printSpeedLine(text, "all rows, online", e.online.motion);
}

}  // namespace motorcade
