#include <chrono>
#include <future>
#include <map>
#include <mutex>
#include <regex>
#include <sstream>
#include <string>
#include <thread>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "apps/view/page_json.hpp"
#include "apps/view/recorded_view.hpp"
#include "apps/view/replay_gate.hpp"
#include "apps/view/request_guard.hpp"
#include "apps/view/run_truth.hpp"
#include "apps/view/viewers.hpp"
#include "io/files/errors.hpp"
#include "tests/io/temporary_folder.hpp"

namespace motorcade {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

EventText text(const std::string& content) { return std::make_shared<const std::string>(content); }

TEST(ListenAddress, IsReadInWholeOrInPart) {
  EXPECT_EQ(parseListenAddress("", "--view").text(), "127.0.0.1:8080");
  EXPECT_EQ(parseListenAddress("9000", "--view").text(), "127.0.0.1:9000");
  EXPECT_EQ(parseListenAddress(":9000", "--view").text(), "127.0.0.1:9000");
  EXPECT_EQ(parseListenAddress("0.0.0.0:9000", "--view").text(), "0.0.0.0:9000");
  EXPECT_EQ(parseListenAddress("localhost", "--view").text(), "localhost:8080");
  EXPECT_EQ(parseListenAddress("[::1]:9000", "--view").text(), "[::1]:9000");
  for (const char* wrong : {"localhost:", "127.0.0.1:65536", "1:2:3", "host/x:80", "a:b", "::1:80"})
    EXPECT_THROW(parseListenAddress(wrong, "--view"), UsageError) << wrong;
}

TEST(ListenAddress, WhatOthersReachIsWarnedOf) {
  for (const char* own : {"127.0.0.1:9000", "127.3.2.1:80", "localhost:80", "[::1]:80"})
    EXPECT_EQ(exposureWarning(parseListenAddress(own, "--view")), "") << own;
  for (const char* open : {"0.0.0.0:9000", "[::]:9000", "10.0.0.7:9000", "carpc:9000"})
    EXPECT_THAT(exposureWarning(parseListenAddress(open, "--view")),
                AllOf(HasSubstr(open), HasSubstr("sees the images"), HasSubstr("hold the run"),
                      HasSubstr("ssh -L 9000:127.0.0.1:9000")));
  EXPECT_EQ(parseListenAddress("0.0.0.0:9000", "--view").localText(), "127.0.0.1:9000");
  EXPECT_EQ(parseListenAddress("[::]:9000", "--view").localText(), "[::1]:9000");
  EXPECT_EQ(parseListenAddress("10.0.0.7:9000", "--view").localText(), "10.0.0.7:9000");
}

TEST(Viewers, TheNewestEventWins) {
  Viewers viewers;
  const auto seat = viewers.admit();
  viewers.publish(text("1"));
  viewers.publish(text("2"));
  viewers.publish(text("3"));
  EXPECT_EQ(*seat->next(0ms), "3");
  EXPECT_EQ(seat->missed(), 2);
  EXPECT_EQ(seat->next(0ms), nullptr);
  EXPECT_EQ(*viewers.admit()->next(0ms), "3") << "who comes later sees the last one";
}

TEST(Viewers, CloseEndsWaitsAfterTheLastEvent) {
  Viewers viewers;
  const auto seat = viewers.admit();
  viewers.publish(text("end"));
  viewers.close();
  EXPECT_FALSE(seat->over());
  EXPECT_EQ(*seat->next(1min), "end");
  EXPECT_EQ(seat->next(1min), nullptr) << "at once";
  EXPECT_TRUE(seat->over());
  EXPECT_EQ(viewers.admit(), nullptr);
}

TEST(ReplayGate, HoldsStepsAndGoesOn) {
  std::promise<void> held;
  std::once_flag once;
  ReplayGate gate([&] {
    std::call_once(once, [&] { held.set_value(); });  // it asks as it waits
    return false;
  });
  EXPECT_EQ(gate.pass({}), SteadyTime::duration{}) << "open";
  gate.step();
  gate.pass({});
  EXPECT_TRUE(gate.paused()) << "after the one pair";
  std::jthread resume([&] {
    held.get_future().wait();
    gate.resume();
  });
  EXPECT_GE(gate.pass({}), 200ms) << "how long it was held";
}

TEST(ReplayGate, AStopAndALeftPageEndTheWait) {
  ReplayGate held([] { return false; });
  held.pause();
  std::stop_source source;
  std::jthread stop([&source] {
    std::this_thread::sleep_for(30ms);
    source.request_stop();
  });
  held.pass(source.get_token());  // else the test hangs
  ReplayGate left([] { return true; });
  left.pause();
  left.pass({});
  EXPECT_FALSE(left.paused());
}

/// A car 12 m ahead that drives where the camera looks.
ShownFrame frameWithACar() {
  Eigen::Matrix3d world_body;
  world_body << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  ObjectEstimate car;
  car.track = {1};
  car.T_world_body = SE3(world_body, {0, 0.75, 12});
  car.velocity_world_mps = {0, 0, 6};
  car.speed_sigma_mps = 0.25;
  car.existence_probability = 0.875;
  car.acceleration = {.along_mps2 = -2.5, .along_sigma_mps2 = 0.5, .yaw_radps2 = 0.25, .yaw_sigma_radps2 = 0.125};
  car.covariance = Matrix6d::Identity() * 0.01;
  car.cuboid = ObjectBox{};
  car.cuboid->size_m = {4, 2, 1.5};
  ShownFrame frame;
  frame.estimate.head.frame = {5};
  frame.estimate.head.stamp = {1'500'000'000};
  frame.estimate.objects = {car};
  frame.outlines = {{{1}, {{{1, 2}, {3, 4}, {5, 6}}}}};
  frame.points = {{{1}, {10, 20}, {1, 2, 3}}};
  frame.road = roadUnder(frame.estimate);
  return frame;
}

TEST(FrameJson, HoldsWhatThePageShows) {
  const json frame = json::parse(toJson(frameWithACar(), {1'000'000'000}));
  EXPECT_EQ(frame["frame"], 5);
  EXPECT_EQ(frame["time"], 0.5);
  EXPECT_EQ(frame["status"], "good");
  const json& car = frame["objects"].at(0);
  EXPECT_EQ(car["id"], 1);
  EXPECT_EQ(car["color"], "#60d86e") << "as in the pictures";
  EXPECT_EQ(car["speed"], 6);
  EXPECT_EQ(car["speed_sigma"], 0.25);
  EXPECT_EQ(car["existence"], 0.875);
  EXPECT_EQ(car["acceleration"], -2.5);
  EXPECT_EQ(car["acceleration_sigma"], 0.5);
  EXPECT_EQ(car["yaw_acceleration"], 0.25);
  EXPECT_EQ(car["yaw_acceleration_sigma"], 0.125);
  EXPECT_NEAR(car["distance"].get<double>(), std::hypot(0.75, 12), 1e-3);
  EXPECT_NEAR(car["distance_sigma"].get<double>(), 0.1, 1e-3);
  EXPECT_THAT(car["cuboid"]["size"], ElementsAre(4, 2, 1.5));
  EXPECT_EQ(frame["outlines"], json::parse(R"([{"id":1,"polygons":[[1,2,3,4,5,6]]}])"));
  EXPECT_EQ(frame["points"], json::parse("[[1,10,20,1,2,3]]"));
  EXPECT_THAT(frame["road"]["point"], ElementsAre(0, 1.5, 0)) << "below the camera, where the car stands";
  EXPECT_FALSE(json::parse(toJson(frameWithACar(), {}, FrameDetail::kWithoutImageParts)).contains("points"));
}

TEST(FrameJson, ALabelHasTheCuboidOfItsBox) {
  ShownFrame frame = frameWithACar();
  ShownTruth truth;
  truth.position_m = 0.25;
  truth.step_m = 0.0125;
  truth.objects.push_back({.label = 7,
                           .type = "Car",
                           .T_world_object = SE3(Eigen::Matrix3d::Identity(), {1, 1.5, 12}),
                           .size_m = {1.5, 1.8, 4},
                           .moving = true,
                           .track = {1},
                           .off_m = 0.75});
  truth.objects.emplace_back().label = 8;
  frame.truth = truth;
  const json of_frame = json::parse(toJson(frame, {}))["truth"];
  EXPECT_EQ(of_frame["position_m"], 0.25);
  EXPECT_EQ(of_frame["step_m"], 0.0125);
  const json& label = of_frame["objects"].at(0);
  EXPECT_THAT(label["cuboid"]["size"], ElementsAre(4, 1.5, 1.8)) << "along its x, y and z axes";
  EXPECT_THAT(label["cuboid"]["center"], ElementsAre(0, -0.75, 0)) << "y is down, and the box stands on its origin";
  EXPECT_EQ(label["track"], 1);
  EXPECT_EQ(label["off_m"], 0.75);
  EXPECT_FALSE(label.contains("motion_m")) << "not known without a frame before";
  EXPECT_FALSE(of_frame["objects"].at(1).contains("track")) << "nothing followed it";
}

TEST(FrameJson, TellsTheWorkWithoutWaiting) {
  ShownFrame frame = frameWithACar();
  frame.timing = ShownTiming{.latency_ms = 467, .stages_ms = {1, 4, 3, 2, 1, 1, 1}};
  EXPECT_EQ(json::parse(toJson(frame, {}))["timing"]["processing_ms"], 10)
      << "of stereo matching and optical flow, side by side, the longer alone";
}

TEST(FrameSpans, AreOfNumbersThatFollowOneAnother) {
  const auto spans = spansOf({3, 4, 5, 9, 11, 12});
  ASSERT_EQ(spans.size(), 3);
  EXPECT_EQ(spans[0].from, 3);
  EXPECT_EQ(spans[0].to, 5);
  EXPECT_EQ(spans[1].from, 9);
  EXPECT_EQ(spans[1].to, 9);
  EXPECT_EQ(spans[2].to, 12);
  EXPECT_TRUE(spansOf({}).empty());
}

TEST(FrameJson, StaysJsonWhereANumberIsNone) {
  ShownFrame frame = frameWithACar();
  frame.estimate.objects[0].speed_sigma_mps = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(json::parse(toJson(frame, {}))["objects"][0]["speed_sigma"].is_null());
}

TEST(FrameJson, AnEventHoldsCountsAndFrame) {
  const RunSnapshot run{.state = "paused", .received = 9, .queues = {{"input>admit", 2, 4}}, .viewers = 1};
  const json event = json::parse(eventJson(run, R"({"frame":3})"));
  EXPECT_EQ(event["run"]["state"], "paused");
  EXPECT_EQ(event["run"]["received"], 9);
  EXPECT_EQ(event["run"]["queues"][0]["waiting"], 2);
  EXPECT_EQ(event["frame"]["frame"], 3);
  EXPECT_TRUE(json::parse(eventJson(run, ""))["frame"].is_null());
}

PipelineResult resultAfter(double latency_ms, FrameStatus status) {
  PipelineResult result;
  result.online.head.status = status;
  const auto after =
      std::chrono::duration_cast<SteadyTime::duration>(std::chrono::duration<double, std::milli>(latency_ms));
  result.timing.published = result.timing.due + after;
  result.timing.of(Stage::kTracking) = {.start = result.timing.due, .end = result.timing.due + after, .worker = 0};
  return result;
}

RunSnapshot countedRun() {
  RunCounts counts;
  counts.count(resultAfter(0.5, FrameStatus::kGood));
  counts.count(resultAfter(12, FrameStatus::kLost));
  PipelineResult late = resultAfter(5000, FrameStatus::kRejected);
  late.dropped.resize(2);
  counts.count(late);
  RunSnapshot run{.state = "running", .queues = {{"input>admit", 1, 4}}};
  counts.read(run);
  return run;
}

TEST(RunCounts, CountsFramesByWhatBecameOfThem) {
  const RunSnapshot run = countedRun();
  EXPECT_EQ(run.processed, 2);
  EXPECT_EQ(run.lost, 1);
  EXPECT_EQ(run.rejected, 1);
  EXPECT_EQ(run.dropped, 2);
  EXPECT_EQ(run.received, 5);
  EXPECT_EQ(run.latency.counts.front(), 1);
  EXPECT_EQ(run.latency.counts.back(), 1);
  EXPECT_NEAR(run.latency.sum_ms, 5012.5, 0.01);
  EXPECT_EQ(run.processing.count(), 3);
}

/// Reads the exposition format 0.0.4 as a scraper does; each problem is a failure. Values by name and labels.
std::map<std::string, double> scraped(const std::string& metrics) {
  static const std::regex kSample(
      R"re(([a-zA-Z_:][a-zA-Z0-9_:]*)(\{([a-zA-Z_][a-zA-Z0-9_]*="[^"\\\n]*"(,(?!\})|(?=\})))*\})? (\S+))re");
  std::map<std::string, double> values;
  std::map<std::string, std::string> types;
  std::istringstream lines(metrics);
  EXPECT_TRUE(metrics.ends_with('\n'));
  for (std::string line; std::getline(lines, line);) {
    std::smatch sample;
    if (line.starts_with("# HELP ")) continue;
    if (line.starts_with("# TYPE ")) {
      const auto name_end = line.find(' ', 7);
      EXPECT_TRUE(types.emplace(line.substr(7, name_end - 7), line.substr(name_end + 1)).second) << line;
      continue;
    }
    if (!std::regex_match(line, sample, kSample)) {
      ADD_FAILURE() << "no sample: " << line;
      continue;
    }
    const std::string family = std::regex_replace(sample[1].str(), std::regex("_(bucket|sum|count)$"), "");
    EXPECT_TRUE(types.contains(sample[1].str()) || types[family] == "histogram") << "without a type before: " << line;
    if (types[sample[1].str()] == "counter") {
      EXPECT_TRUE(sample[1].str().ends_with("_total")) << line;
    }
    EXPECT_TRUE(values.emplace(sample[1].str() + sample[2].str(), std::stod(sample[5])).second) << "twice: " << line;
  }
  return values;
}

TEST(Metrics, AreInTheExpositionFormat) {
  const auto values = scraped(metricsText(countedRun()));
  EXPECT_EQ(values.at("motorcade_frames_received_total"), 5);
  EXPECT_EQ(values.at("motorcade_frames_dropped_total"), 2);
  EXPECT_EQ(values.at("motorcade_queue_frames{queue=\"input>admit\"}"), 1);
  EXPECT_EQ(values.at("motorcade_viewers"), 0);
  EXPECT_EQ(values.at("motorcade_latency_seconds_bucket{le=\"0.01\"}"), 1) << "cumulated";
  EXPECT_EQ(values.at("motorcade_latency_seconds_bucket{le=\"0.015\"}"), 2);
  EXPECT_EQ(values.at("motorcade_latency_seconds_bucket{le=\"+Inf\"}"), 3);
  EXPECT_EQ(values.at("motorcade_latency_seconds_count"), 3);
  EXPECT_NEAR(values.at("motorcade_latency_seconds_sum"), 5.0125, 1e-5);
  EXPECT_EQ(values.at("motorcade_stage_seconds_bucket{stage=\"tracking\",le=\"0.001\"}"), 1);
  EXPECT_EQ(values.at("motorcade_stage_seconds_count{stage=\"prepare\"}"), 0);
}

TEST(RecordedFiles, OutlinesComeBackAsTheyWereWritten) {
  const test::TemporaryFolder folder;
  const std::vector<Polygon> polygons{{{1, 2}, {3, 4}, {5, 6}}};
  folder.write("outlines.jsonl", outlineLine({7}, {3}, polygons) + "\n");
  const auto lines = readOutlineLines(folder.path());
  ASSERT_EQ(lines.at(7).size(), 1);
  const ShownOutline outline = outlineOf(lines.at(7).front());
  EXPECT_EQ(outline.track, TrackId{3});
  EXPECT_EQ(outline.polygons, polygons);
  EXPECT_TRUE(outlineOf(R"({"frame":7,"track_id":3,"polygons":[[["x")").polygons.empty());
}

}  // namespace
}  // namespace motorcade
