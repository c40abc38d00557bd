#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "apps/evaluate/report/report.hpp"

namespace motorcade {
namespace {

void printCameraLine(std::string& text, const char* kind, const std::optional<TrajectoryErrors>& errors) {
  if (!errors) return print(text, "  {:<8} too few poses\n", kind);
  print(text, "  {:<8} {:7.3f} {:7.3f} {:7.3f}  {:8.3f}  {:7.2f} %  {:7.4f} {:7.4f}  {:7.4f} {:7.4f}  {:7.3f}\n", kind,
        errors->ate_m.rmse, errors->ate_m.mean, errors->ate_m.median, errors->ate_first_pose_m.rmse,
        errors->end_percent, errors->rpe_m.rmse, errors->rpe_m.median, errors->rpe_deg.rmse, errors->rpe_deg.median,
        errors->are_deg.mean);
}

/// Column of one of the two errors, with its number of digits.
struct SegmentColumn {
  double SegmentMeans::*error;
  const char* unit;
  int digits;
};
constexpr SegmentColumn kTranslation{&SegmentMeans::translation_percent, "%", 3},
    kRotation{&SegmentMeans::rotation_deg_per_m, "deg/m", 4};

void printSegmentLine(std::string& text, const char* kind, const SegmentErrors& errors, const SegmentColumn& column) {
  print(text, "  {:<8} {:<5} {:6}  {:7.{}f} ", kind, column.unit, errors.all.segments, errors.all.*column.error,
        column.digits);
  for (const auto& of_length : errors.by_length) {
    if (of_length.segments > 0)
      print(text, " {:7.{}f}", of_length.*column.error, column.digits);
    else
      print(text, " {:>7}", "-");
  }
  text += '\n';
}

void printSegments(std::string& text, const Evaluation& e) {
  const auto &final = e.final.camera_segments, &online = e.online.camera_segments;
  const auto& any = final ? final : online;
  if (!any) return;
  print(text, "\nmotion over segments of {} to {} m, as the KITTI odometry benchmark measures it{}\n",
        any->short_segments ? 10 : 100, any->short_segments ? 80 : 800,
        any->short_segments ? "; the drive is\nshorter than 300 m, so that these are a tenth of the benchmark's" : "");
  text += "               segments     mean ";
  for (const auto& of_length : any->by_length) print(text, " {:5.0f} m", of_length.length_m);
  text += '\n';
  for (const auto& [kind, errors] : {std::pair("final", &final), std::pair("online", &online)}) {
    if (!*errors) continue;
    printSegmentLine(text, kind, **errors, kTranslation);
    printSegmentLine(text, "", **errors, kRotation);
  }
}

/// Prints the contradiction between positions and velocities of the truth.
void printDoubt(std::string& text, const TruthCheck& check) {
  print(text, "doubt     positions and velocities of the truth contradict each other:\n");
  if (check.waysDiffer())
    print(text, "          the way is {:.1f} m by positions and {:.1f} m by velocities, {:.1f} % apart\n", check.way_m,
          check.velocity_way_m, std::abs(check.differencePercent()));
  if (check.jumps())
    print(text, "          from frame {} to {} they are {:.1f} m apart\n", check.step_from.value, check.step_to.value,
          check.largest_step_m);
  print(text, "          errors of that size say nothing of the run; --truth velocity measures by velocities\n");
}

void printOtherFrame(std::string& text, double course_difference_deg) {
  print(text,
        "doubt     run and truth go ways {:.0f} deg apart, each as its camera sees it: unless the run is wrong,\n",
        course_difference_deg);
  print(text, "          the truth's poses are of another frame than the left camera's (x right, y down, z ahead),\n");
  print(text, "          or its quaternions in another order\n");
}

std::string labelName(std::int64_t label, const std::string& type) {
  std::string name;
  print(name, "{:<6} {}", label, type);
  return name;
}

void printMotion(std::string& text, const std::string& whose, const MotionErrors& m) {
  print(text, "  {:<21.21}  {:7.3f} {:7.3f}  {:7.2f} {:7.2f}  {:7.2f} {:+7.2f}\n", whose, m.me_m.mean, m.me_m.rmse,
        m.me_deg.mean, m.me_deg.rmse, m.speed_mps.rmse, m.speed_bias_mps);
}

void printStatistics(std::string& text, const std::string& whose, const Statistics& m, const Statistics& deg) {
  print(text, "  {:<21.21}  {:7.3f} {:7.3f} {:7.3f} {:7.3f} {:7.3f} ", whose, m.rmse, m.mean, m.median, m.p95, m.max);
  print(text, " {:6.2f} {:6.2f} {:6.2f} {:6.2f} {:6.2f}\n", deg.rmse, deg.mean, deg.median, deg.p95, deg.max);
}

/// Prints the mean of the objects' root mean squares, which stand above it.
void printObjectRms(std::string& text, const char* whose, const FollowedMotion& motion) {
  if (!motion.objects.empty())
    print(text, "  {:<21.21}  {:7.3f} {:>33} {:6.2f}\n", whose, motion.rms_m, "", motion.rms_deg);
}

void printLargest(std::string& text, const char* what, const LargestStep& step, const char* unit) {
  if (step.label < 0) return;
  print(text, "  {:<21.21}  {:7.3f} {} in frame {}, label {}, track {}\n", what, step.error, unit, step.frame.value,
        step.label, step.track.value);
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
  print(text, "  {:<8} {:6}", what, errors->rows);
  for (const CoveredErrors* of : {&errors->along_mps2, &errors->yaw_radps2})
    print(text, "  {:7} {:7.3f} {:7.3f} {:5.1f} %", of->errors.count, of->errors.rmse, of->errors.max,
          100 * of->coverage);
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

void printHead(std::string& text, const Evaluation& e) {
  print(text, "run       {}{}\n", e.run.native(), e.complete ? "" : "  (did not complete)");
  print(text, "sequence  {}\n", e.sequence.native());
  print(text, "frames    {} from frame {}; lost {}, rejected {}, dropped {}\n", e.frames_run, e.first_frame, e.lost,
        e.rejected, e.dropped);
  if (e.finals_recovered > 0)
    print(text, "finals    of the last {} frames are online estimates: the run did not end in order\n",
          e.finals_recovered);
  print(text, "truth     camera from {}{}{}\n", e.camera_source, e.object_source.empty() ? "" : ", objects from ",
        e.object_source);
  if (e.truth_check && e.truth_check->doubtful()) printDoubt(text, *e.truth_check);
  const double course_difference_deg = std::max(e.final.course_difference_deg, e.online.course_difference_deg);
  if (course_difference_deg > kOtherFrame_deg) printOtherFrame(text, course_difference_deg);
}

void printCamera(std::string& text, const Evaluation& e) {
  text += "\ncamera       ATE m                  1st pose  end error   RPE_t m          RPE_r deg       ARE deg\n";
  text += "              rmse    mean  median      rmse                rmse  median     rmse  median     mean\n";
  printCameraLine(text, "final", e.final.camera);
  printCameraLine(text, "online", e.online.camera);
  if (e.mounting) {
    const Eigen::Vector3d turn_deg = logSO3(e.mounting->rotation()) * 180 / std::numbers::pi,
                          arm_m = e.mounting->translation();
    print(text, "without the truth's mounting (rotation {:.2f} {:.2f} {:.2f} deg, lever arm {:.2f} {:.2f} {:.2f} m):\n",
          turn_deg.x(), turn_deg.y(), turn_deg.z(), arm_m.x(), arm_m.y(), arm_m.z());
    printCameraLine(text, "final", e.final.camera_mounted);
    printCameraLine(text, "online", e.online.camera_mounted);
  }
  printSegments(text, e);
}

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
