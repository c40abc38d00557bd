#include "apps/evaluate/report/table_text.hpp"

namespace motorcade {
namespace {

std::string labelName(std::int64_t label, const std::string& type) {
  std::string name;
  print(name, "%-6lld %s", static_cast<long long>(label), type.c_str());
  return name;
}

void printMotion(std::string& text, const std::string& whose, const MotionErrors& m) {
  print(text, "  %-21.21s  %7.3f %7.3f  %7.2f %7.2f  %7.2f %+7.2f\n", whose.c_str(), m.me_m.mean, m.me_m.rmse,
        m.me_deg.mean, m.me_deg.rmse, m.speed_mps.rmse, m.speed_bias_mps);
}

void printStatistics(std::string& text, const std::string& whose, const Statistics& m, const Statistics& deg) {
  print(text, "  %-21.21s  %7.3f %7.3f %7.3f %7.3f %7.3f ", whose.c_str(), m.rmse, m.mean, m.median, m.p95, m.max);
  print(text, " %6.2f %6.2f %6.2f %6.2f %6.2f\n", deg.rmse, deg.mean, deg.median, deg.p95, deg.max);
}

/// Prints the mean of the objects' root mean squares, which stand above it.
void printObjectRms(std::string& text, const char* whose, const FollowedMotion& motion) {
  if (!motion.objects.empty()) print(text, "  %-21.21s  %7.3f %33s %6.2f\n", whose, motion.rms_m, "", motion.rms_deg);
}

void printLargest(std::string& text, const char* what, const LargestStep& step, const char* unit) {
  if (step.label < 0) return;
  print(text, "  %-21.21s  %7.3f %s in frame %lld, label %lld, track %lld\n", what, step.error, unit,
        static_cast<long long>(step.frame.value), static_cast<long long>(step.label),
        static_cast<long long>(step.track.value));
}

/// The form of published figures.
void printFollowed(std::string& text, const Evaluation& e) {
  const FollowedMotion &final = e.final.followed_motion, &online = e.online.followed_motion;
  if (final.objects.empty() && online.objects.empty()) return;
  text += "\nmotion of all followed     ME_t m                                   ME_r deg\n";
  text += "                             rms    mean  median     p95     max     rms   mean median    p95    max\n";
  for (const LabelMotion& object : final.objects)
    printStatistics(text, labelName(object.label, object.type), object.me_m, object.me_deg);
  printStatistics(text, "all steps, final", final.me_m, final.me_deg);
  printStatistics(text, "all steps, online", online.me_m, online.me_deg);
  printObjectRms(text, "objects' mean, final", final);
  printObjectRms(text, "objects' mean, online", online);
  printLargest(text, "largest step, final", final.largest_m, "m");
  printLargest(text, "largest step, online", online.largest_m, "m");
  printLargest(text, "largest turn, final", final.largest_deg, "deg");
  printLargest(text, "largest turn, online", online.largest_deg, "deg");
}

void printAccelerationLine(std::string& text, const char* what, const std::optional<AccelerationErrors>& errors) {
  if (!errors || errors->rows == 0) return;
  print(text, "  %-8s %6d", what, errors->rows);
  for (const CoveredErrors* of : {&errors->along_mps2, &errors->yaw_radps2})
    print(text, "  %7zu %7.3f %7.3f %5.1f %%", of->errors.count, of->errors.rmse, of->errors.max, 100 * of->coverage);
  text += '\n';
}

void printAccelerations(std::string& text, const Evaluation& e) {
  std::string lines;
  printAccelerationLine(lines, "final", e.final.acceleration);
  printAccelerationLine(lines, "online", e.online.acceleration);
  if (lines.empty()) return;
  text += "\nacceleration            along the path, m/s2             of the yaw rate, rad/s2\n";
  text += "             rows     told    rmse     max  in 95 %     told    rmse     max  in 95 %\n" + lines;
}

}  // namespace

void printMotions(std::string& text, const Evaluation& e) {
  text += "\nmotion of the same         ME_t m           ME_r deg         speed m/s\n";
  text += "                            mean    rmse     mean    rmse     rmse    bias\n";
  for (const auto& object : e.final.objects)
    if (object.positions) printMotion(text, labelName(object.label, object.type), object.motion);
  printMotion(text, "all rows, final", e.final.motion);
  printMotion(text, "all rows, online", e.online.motion);
  printFollowed(text, e);
  printAccelerations(text, e);
}

}  // namespace motorcade
