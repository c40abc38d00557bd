#include "apps/bridge/messages/diagnostics.hpp"

#include <map>
#include <string>

#include <gmock/gmock.h>

#include "tests/apps/bridge/bridged_object_by_hand.hpp"

namespace motorcade::test {
namespace {

using Level = ros::DiagnosticStatus::Level;
using Status = Result::Status;
using Cause = Result::Cause;

ros::DiagnosticStatus statusOf(Status status, Cause cause, const std::string& problem = "") {
  Result result = bridgedResult({bridgedObject()});
  result.status = status;
  result.cause = cause;
  result.problem = problem;
  return diagnosticsOf(result, "drive").status.at(0);
}

TEST(Diagnostics, HaveTheLevelOfStatusAndCause) {
  EXPECT_EQ(statusOf(Status::kGood, Cause::kNone).level, Level::kOk);
  EXPECT_EQ(statusOf(Status::kGood, Cause::kAfterGap).level, Level::kWarn);
  EXPECT_EQ(statusOf(Status::kGood, Cause::kFewPoints).level, Level::kWarn);
  EXPECT_EQ(statusOf(Status::kLost, Cause::kNoPoints).level, Level::kError);
  EXPECT_EQ(statusOf(Status::kRejected, Cause::kUnusable).level, Level::kError);
  EXPECT_EQ(statusOf(Status::kGood, Cause::kNone, "the right image is turned").level, Level::kError)
      << "what of the rig makes results worthless";
}

TEST(Diagnostics, SayInWordsWhatIsWrong) {
  EXPECT_EQ(statusOf(Status::kGood, Cause::kNone).message, "measured");
  EXPECT_EQ(statusOf(Status::kLost, Cause::kUnlinked).message, "lost: points are seen, but not how the camera moved");
  EXPECT_EQ(statusOf(Status::kRejected, Cause::kUnusable, "left: cut off").message,
            "rejected: the images are of no use; left: cut off");
}

TEST(Diagnostics, TellOfTheFrame) {
  Result result = bridgedResult({bridgedObject(), bridgedObject()});
  result.cause = Cause::kAfterGap;
  result.segment = 2;
  result.dropped_before = 4;
  result.latency_ms = 31.26;
  const ros::DiagnosticArray array = diagnosticsOf(result, "0003");
  EXPECT_EQ(array.header.stamp.sec, 5);
  ASSERT_EQ(array.status.size(), 1U);
  EXPECT_EQ(array.status[0].name, "motorcade: tracker");
  EXPECT_EQ(array.status[0].hardware_id, "0003");
  std::map<std::string, std::string> values;
  for (const auto& [key, value] : array.status[0].values) values[key] = value;
  const std::map<std::string, std::string> expected{{"frame", "3"},         {"cause", "after_gap"},  {"segment", "2"},
                                                    {"latency_ms", "31.3"}, {"dropped_before", "4"}, {"objects", "2"}};
  EXPECT_EQ(values, expected);
}

}  // namespace
}  // namespace motorcade::test
