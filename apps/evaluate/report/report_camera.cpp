#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "apps/evaluate/report/table_text.hpp"

namespace motorcade {
namespace {

void printCameraLine(std::string& text, const char* kind, const std::optional<TrajectoryErrors>& errors) {
  if (!errors) return print(text, "  %-8s too few poses\n", kind);
  print(text, "  %-8s %7.3f %7.3f %7.3f  %8.3f  %7.2f %%  %7.4f %7.4f  %7.4f %7.4f  %7.3f\n", kind, errors->ate_m.rmse,
        errors->ate_m.mean, errors->ate_m.median, errors->ate_first_pose_m.rmse, errors->end_percent,
        errors->rpe_m.rmse, errors->rpe_m.median, errors->rpe_deg.rmse, errors->rpe_deg.median, errors->are_deg.mean);
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
  print(text, "  %-8s %-5s %6zu  %7.*f ", kind, column.unit, errors.all.segments, column.digits,
        errors.all.*column.error);
  for (const auto& of_length : errors.by_length) {
    if (of_length.segments > 0)
      print(text, " %7.*f", column.digits, of_length.*column.error);
    else
      print(text, " %7s", "-");
  }
  text += '\n';
}

void printSegments(std::string& text, const Evaluation& e) {
  const auto &final = e.final.camera_segments, &online = e.online.camera_segments;
  const auto& any = final ? final : online;
  if (!any) return;
  print(text, "\nmotion over segments of %d to %d m, as the KITTI odometry benchmark measures it%s\n",
        any->short_segments ? 10 : 100, any->short_segments ? 80 : 800,
        any->short_segments ? "; the drive is\nshorter than 300 m, so that these are a tenth of the benchmark's" : "");
  text += "               segments     mean ";
  for (const auto& of_length : any->by_length) print(text, " %5.0f m", of_length.length_m);
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
    print(text, "          the way is %.1f m by positions and %.1f m by velocities, %.1f %% apart\n", check.way_m,
          check.velocity_way_m, std::abs(check.differencePercent()));
  if (check.jumps())
    print(text, "          from frame %lld to %lld they are %.1f m apart\n",
          static_cast<long long>(check.step_from.value), static_cast<long long>(check.step_to.value),
          check.largest_step_m);
  print(text, "          errors of that size say nothing of the run; --truth velocity measures by velocities\n");
}

void printOtherFrame(std::string& text, double course_difference_deg) {
  print(text, "doubt     run and truth go ways %.0f deg apart, each as its camera sees it: unless the run is wrong,\n",
        course_difference_deg);
  print(text, "          the truth's poses are of another frame than the left camera's (x right, y down, z ahead),\n");
  print(text, "          or its quaternions in another order\n");
}

}  // namespace

void printHead(std::string& text, const Evaluation& e) {
  print(text, "run       %s%s\n", e.run.c_str(), e.complete ? "" : "  (did not complete)");
  print(text, "sequence  %s\n", e.sequence.c_str());
  print(text, "frames    %zu from frame %lld; lost %d, rejected %d, dropped %d\n", e.frames_run,
        static_cast<long long>(e.first_frame), e.lost, e.rejected, e.dropped);
  if (e.finals_recovered > 0)
    print(text, "finals    of the last %zu frames are online estimates: the run did not end in order\n",
          e.finals_recovered);
  print(text, "truth     camera from %s%s%s\n", e.camera_source.c_str(),
        e.object_source.empty() ? "" : ", objects from ", e.object_source.c_str());
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
    print(text, "without the truth's mounting (rotation %.2f %.2f %.2f deg, lever arm %.2f %.2f %.2f m):\n",
          turn_deg.x(), turn_deg.y(), turn_deg.z(), arm_m.x(), arm_m.y(), arm_m.z());
    printCameraLine(text, "final", e.final.camera_mounted);
    printCameraLine(text, "online", e.online.camera_mounted);
  }
  printSegments(text, e);
}

}  // namespace motorcade
