#include "core/edit_distance.hpp"

#include <gtest/gtest.h>

namespace motorcade {
namespace {

TEST(EditDistance, CountsLettersToChangeToAddAndToTakeAway) {
  EXPECT_EQ(editDistance("threads", "threads"), 0U);
  EXPECT_EQ(editDistance("thread", "threads"), 1U);
  EXPECT_EQ(editDistance("kitten", "sitting"), 3U);
  EXPECT_EQ(editDistance("", "run"), 3U);
  EXPECT_EQ(editDistance("run", ""), 3U);
}

TEST(NearestName, IsTheOneThatWasLikelyMeantOrNone) {
  const std::vector<std::string> names{"run", "evaluate", "draw", "synth"};
  EXPECT_EQ(nearestName("evalaute", names), "evaluate");
  EXPECT_EQ(nearestName("rum", names), "run");
  EXPECT_EQ(nearestName("x", names), "");
  EXPECT_EQ(nearestName("calibrate", names), "");
  EXPECT_EQ(nearestName("run", {}), "");
}

}  // namespace
}  // namespace motorcade
