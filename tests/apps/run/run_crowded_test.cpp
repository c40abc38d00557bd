#include <algorithm>
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "io/results/run_folder.hpp"
#include "tests/apps/program_run.hpp"

/// Drives with hardly anything at rest in view.
namespace motorcade::test {
namespace {

class CrowdedRun : public Run {
 protected:
  /// Drift of the camera against an exact truth [m].
  double drift_m(const fs::path& sequence, const std::string& options = "") {
    EXPECT_EQ(run("out", "--force " + options, sequence), 0) << contentOf(errors());
    return evaluate("out", sequence)["final"]["camera"]["ate_m"]["rmse"].get<double>();
  }
};

TEST_F(CrowdedRun, TheCameraIsNotCarriedOffByVehiclesOnAllSides) {
  EXPECT_LT(drift_m(MOTORCADE_WALLED_IN_SEQUENCE), 0.1);  // 8 m where it follows them
  EXPECT_EQ(summary("out")["frames"]["segments"], 1);
}

TEST_F(CrowdedRun, ATruckThatFillsTheViewDoesNotCarryTheCameraOff) {
  EXPECT_LT(drift_m(MOTORCADE_TRUCK_SEQUENCE), 0.4);  // 2.5 m where it does
  EXPECT_GT(summary("out")["frames"]["lost"], 5);     // and it says so
  const auto found = evaluate("out", MOTORCADE_TRUCK_SEQUENCE)["final"]["detection"]["within_30m"];
  EXPECT_GT(found["recall"], 0.65);  // 0.54 where objects end with the frames that are not linked
}

TEST_F(CrowdedRun, ACrowdIsFollowedWithinTheBoundOnObjects) {
  for (const int most : {3, 64}) {
    EXPECT_LT(drift_m(MOTORCADE_CROWD_SEQUENCE, "--set frontend.tracking.max_objects=" + std::to_string(most)), 0.03);
    const RunFolder folder = readRunFolder(out("out"));
    std::map<FrameId, int> rows;
    for (const auto& row : folder.online.objects) ++rows[row.frame];
    int most_at_once = 0;
    for (const auto& [frame, count] : rows) most_at_once = std::max(most_at_once, count);
    EXPECT_LE(most_at_once, most);
    if (most > 3) {
      EXPECT_GT(most_at_once, 5);
    }
  }
}

}  // namespace
}  // namespace motorcade::test
