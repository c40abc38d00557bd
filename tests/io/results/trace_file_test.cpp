#include "io/results/trace_file.hpp"

#include <chrono>
#include <map>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "tests/io/results/timing_by_hand.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using test::timingOf;
using Json = nlohmann::json;

Json eventsOf(const std::vector<FrameTiming>& timings) {
  const test::TemporaryFolder folder;
  TraceFile trace(folder / "trace.json");
  for (const FrameTiming& timing : timings) trace.write(timing);
  trace.close();
  return Json::parse(folder.read("trace.json"));
}

std::vector<Json> select(const Json& events, const std::string& phase, const std::string& name) {
  std::vector<Json> selected;
  for (const Json& event : events)
    if (event["ph"] == phase && event["name"] == name) selected.push_back(event);
  return selected;
}

TEST(TraceFile, ShowsStagesOnNamedThreadsAndDecodingOnItsOwn) {
  const Json events = eventsOf({timingOf(0), timingOf(1)});
  std::map<int, std::string> threads;
  for (const Json& event : select(events, "M", "thread_name")) threads[event["tid"]] = event["args"]["name"];
  const auto tracking = select(events, "X", "tracking");
  ASSERT_EQ(tracking.size(), 2u);
  EXPECT_EQ(threads.at(tracking[0]["tid"]), "worker 0");
  EXPECT_EQ(threads.at(tracking[1]["tid"]), "worker 1");
  EXPECT_DOUBLE_EQ(tracking[1]["dur"], 3000);
  EXPECT_EQ(tracking[1]["args"]["frame"], 1);
  const auto decode = select(events, "X", "decode");
  ASSERT_EQ(decode.size(), 2u);
  EXPECT_EQ(threads.at(decode[0]["tid"]), "decoding ahead");
  EXPECT_DOUBLE_EQ(decode[0]["ts"], -48'000);  // it took 8 ms, and was done 40 ms before the frame was due
}

TEST(TraceFile, EveryWaitThatBeginsEnds) {
  const Json events = eventsOf({timingOf(0), timingOf(1), timingOf(2)});
  std::map<std::string, int> open;
  for (const Json& event : events) {
    if (event["ph"] == "b") ++open[event["name"].get<std::string>()];
    if (event["ph"] == "e") --open[event["name"].get<std::string>()];
  }
  EXPECT_TRUE(open.contains("wait: admit"));
  EXPECT_TRUE(open.contains("wait: scene_flow_segmentation"));
  for (const auto& [name, count] : open) EXPECT_EQ(count, 0) << name;
}

TEST(TraceFile, AnArrowLeadsFromEachFrameToTheNext) {
  const Json events = eventsOf({timingOf(0), timingOf(1), timingOf(2)});
  const auto from = select(events, "s", "frame to frame"), to = select(events, "f", "frame to frame");
  ASSERT_EQ(from.size(), 2u);
  ASSERT_EQ(to.size(), 2u);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(from[i]["id"], to[i]["id"]);
    EXPECT_DOUBLE_EQ(to[i]["ts"].get<double>() - from[i]["ts"].get<double>(), 100'000);  // the frames' distance
  }
}

TEST(TraceFile, CountsFramesInFlightAndMarksThoseThatWereDropped) {
  FrameTiming second = timingOf(1), dropped;
  second.due = second.admitted = timingOf(0).admitted + std::chrono::milliseconds(5);  // while the first is under way
  dropped.head.frame = {2};
  dropped.due = dropped.published = timingOf(2).due;
  dropped.head.status = FrameStatus::kDropped;
  dropped.head.cause = FrameCause::kTooLate;
  const Json events = eventsOf({timingOf(0), second, dropped, timingOf(3)});
  const auto in_flight = select(events, "C", "frames in flight");
  ASSERT_EQ(in_flight.size(), 3u);
  EXPECT_EQ(in_flight[0]["args"]["frames"], 1);
  EXPECT_EQ(in_flight[1]["args"]["frames"], 2);
  EXPECT_EQ(in_flight[2]["args"]["frames"], 1);
  const auto marks = select(events, "i", "dropped");
  ASSERT_EQ(marks.size(), 1u);
  EXPECT_EQ(marks[0]["args"]["cause"], "too_late");
}

}  // namespace
}  // namespace motorcade
