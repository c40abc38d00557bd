#include "apps/merge/measures.hpp"

#include <set>
#include <string>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

TEST(MeasureNames, AreWordsWithUnits) {
  EXPECT_EQ(readableName("camera_ate_m"), "camera ATE [m]");
  EXPECT_EQ(readableName("camera_rpe_t_rmse_m"), "camera RPE of translation, RMSE [m]");
  EXPECT_EQ(readableName("camera_rpe_r_rmse_deg"), "camera RPE of rotation, RMSE [deg]");
  EXPECT_EQ(readableName("online_me_t_m"), "motion error of objects, translation, online [m]");
  EXPECT_EQ(readableName("recall_30_to_50m"), "recall, from 30 to 50 m");
  EXPECT_EQ(readableName("online_yaw_acceleration_rmse_radps2"), "yaw acceleration, RMSE, online [rad/s2]");
  EXPECT_EQ(readableName("recall_30m"), "recall, to 30 m");
  EXPECT_EQ(readableName("latency_p99_ms"), "latency, 99th percentile [ms]");
  EXPECT_EQ(readableName("online_existence_brier"), "Brier score of existence, online");
  EXPECT_EQ(readableName("online_kinds_log_loss"), "log loss of kinds, online");
  EXPECT_EQ(readableName("box_width_in_2_sigma"), "share of widths within two standard deviations");
  EXPECT_EQ(readableName("box_iou_bird"), "box IoU from above");
  EXPECT_EQ(readableName("camera_end_error_percent"), "camera error at the end [%]");
  EXPECT_EQ(readableName("camera_kitti_r_deg_per_m"), "camera KITTI r [deg/m]") << "of words that are not known, too";
}

TEST(MeasureNames, NoTwoAreTheSameAndNoneIsAKey) {
  std::set<std::string> names;
  for (const Measure& measure : allMeasures()) {
    const std::string name = readableName(measure.name);
    EXPECT_EQ(name.find('_'), std::string::npos) << name;
    EXPECT_TRUE(names.insert(name).second) << name;
  }
}

}  // namespace
}  // namespace motorcade
