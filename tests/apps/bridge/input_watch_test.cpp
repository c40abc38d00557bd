#include "apps/bridge/input_watch.hpp"

#include <chrono>
#include <string>
#include <vector>

#include <gmock/gmock.h>

namespace motorcade::test {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::IsEmpty;

/// A watch on a clock that the tests move.
class WatchedInput : public testing::Test {
 protected:
  /// Messages in that time, of cameras at ten hertz.
  std::vector<std::string> toldIn(std::chrono::milliseconds time, bool left, bool right, bool paired) {
    std::vector<std::string> told;
    for (const auto end = now_ + time; now_ < end; now_ += 100ms) {
      if (left) watch_.imageCame(StereoSide::kLeft, now_);
      if (right) watch_.imageCame(StereoSide::kRight, now_);
      if (paired) watch_.pairCame(now_);
      for (const auto& news : watch_.look(now_)) told.push_back((news.bad ? "bad: " : "good: ") + news.text);
    }
    return told;
  }

  InputWatch::Clock::time_point now_{1h};
  InputWatch watch_{{.topics = {"/l", "/r"}, .tolerance_ns = 5'000'000, .patience = 2s}, now_};
};

TEST_F(WatchedInput, IsSilentAboutCamerasThatWork) {
  EXPECT_THAT(toldIn(10s, true, true, true), IsEmpty());
  EXPECT_EQ(watch_.problem(), "");
}

TEST_F(WatchedInput, ASideThatFallsSilentIsToldOnceAndSoIsItsReturn) {
  toldIn(1s, true, true, true);
  EXPECT_THAT(toldIn(20s, true, false, false), ElementsAre("bad: no images on /r for 2.0 s"));
  EXPECT_EQ(watch_.problem(), "no images on /r for 2.0 s");
  EXPECT_THAT(toldIn(5s, true, true, true), ElementsAre("good: images come again on /r"));
  EXPECT_EQ(watch_.problem(), "");
}

TEST_F(WatchedInput, SilenceFromTheBeginningIsToldOfBothSides) {
  EXPECT_THAT(toldIn(5s, false, false, false),
              ElementsAre("bad: no images on /l for 2.0 s", "bad: no images on /r for 2.0 s"));
  EXPECT_EQ(watch_.problem(), "no images on /l for 2.0 s; no images on /r for 2.0 s");
}

TEST_F(WatchedInput, StampsThatNeverAgreeAreTold) {
  EXPECT_THAT(toldIn(10s, true, true, false),
              ElementsAre("bad: no pairs: no stamps on /l and /r are within 5 ms of each other"));
  EXPECT_THAT(toldIn(10s, true, true, true), ElementsAre("good: stamps agree again"));
}

TEST_F(WatchedInput, IsAnErrorInTheDiagnosticsWithItsCounts) {
  using InputLevel = ros::DiagnosticStatus::Level;
  InputCounts counts{.pairs = 7};
  counts.unpaired = {1, 2};
  const auto well = inputStatusOf(counts, "", "/l,/r");
  EXPECT_EQ(well.level, InputLevel::kOk);
  EXPECT_EQ(well.hardware_id, "/l,/r");
  const auto bad = inputStatusOf(counts, "no images on /r for 2.0 s", "/l,/r");
  EXPECT_EQ(bad.level, InputLevel::kError);
  EXPECT_EQ(bad.message, "no images on /r for 2.0 s");
  EXPECT_EQ(bad.values.at(0).value, "7");
  EXPECT_EQ(bad.values.at(2).key, "unpaired_right");
  EXPECT_EQ(bad.values.at(2).value, "2");
}

}  // namespace
}  // namespace motorcade::test
