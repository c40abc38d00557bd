#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <map>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>

#include "apps/bridge/dds/dds_publisher.hpp"
#include "apps/bridge/messages/message_conversion.hpp"
#include "motorcade/motorcade.hpp"
#include "tests/apps/bridge/bridge_process.hpp"
#include "tests/support/matchers.hpp"

/// Tests `motorcade bridge` as other processes see it: what a subscriber gets, and what it may do to the bridge.
namespace motorcade::test {
namespace {

using testing::HasSubstr;

void expectOdometry(const json& message, const Result& result) {
  expectStamped(message["header"], result, "map");
  expectPose(message["pose"], transformOf(result.T_world_cam));
  EXPECT_EQ(message["child_frame_id"], "base_link");
  const auto& v = result.velocity;
  expectNumbers(message["linear"], std::array{v[0], v[1], v[2]});
  expectNumbers(message["angular"], std::array{v[3], v[4], v[5]});
  expectNumbers(message["twist_covariance"], result.velocity_covariance);
  EXPECT_LT(message["pose_covariance"][0], 1) << "known, after so few frames";
}

/// Each object has a label with its id, and one with a size a cube of that size.
void expectMarkers(const json& markers, const Result& result) {
  std::map<std::pair<std::string, std::int64_t>, json> added;
  for (const json& marker : markers)
    if (marker["action"] == 0) added[{marker["ns"], marker["id"]}] = marker;
  for (const Result::Object& object : result.objects) {
    const std::string label = added[{"label", object.id}].value("text", std::string());
    EXPECT_TRUE(label.starts_with(std::to_string(object.id) + ": ")) << label;
    if (object.box_size_m[0] == 0) continue;
    expectNumbers(added[{"box", object.id}]["scale"], object.box_size_m);
  }
  EXPECT_GE(added.size(), result.objects.size());
}

TEST_F(Bridge, EveryMessageArrivesInOrderAndIsWhatTheTrackerGives) {
  Process subscriber = this->subscriber();
  Process bridge = this->bridge({"--rate", "10", "--wait-for-subscribers", "1", "--frame-ids", "map,base_link"});
  ASSERT_EQ(bridge.end(60s), 0) << bridge.said();
  ASSERT_EQ(subscriber.end(20s), 0) << "it ends when the bridge has gone";
  const std::string lines = subscriber.said();
  const auto poses = messagesOf(lines, "rt/motorcade/pose"), odometry = messagesOf(lines, "rt/motorcade/odometry"),
             objects = messagesOf(lines, "rt/motorcade/objects");
  const auto results = trackedHere();
  ASSERT_EQ(results.size(), static_cast<std::size_t>(MOTORCADE_RENDERED_FRAMES));
  ASSERT_EQ(poses.size(), results.size()) << bridge.said();
  ASSERT_EQ(odometry.size(), results.size());
  ASSERT_EQ(objects.size(), results.size());
  std::size_t seen = 0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    SCOPED_TRACE(i);
    expectStamped(poses[i]["header"], results[i], "map");
    expectPose(poses[i]["pose"], transformOf(results[i].T_world_cam));
    expectOdometry(odometry[i], results[i]);
    expectMarkers(objects[i]["markers"], results[i]);
    seen += results[i].objects.size();
  }
  EXPECT_EQ(objects[0]["markers"][0]["action"], 3) << "what an earlier bridge left is deleted";
  EXPECT_GT(seen, 0U) << "objects appear";
}

TEST_F(Bridge, LoopsWithStampsThatGoOnUntilASignal) {
  Process subscriber = this->subscriber();
  Process bridge = this->bridge({"--rate", "40", "--loop", "--wait-for-subscribers", "1"});
  std::this_thread::sleep_for(2s);
  bridge.tell(SIGTERM);
  EXPECT_EQ(bridge.end(20s), 128 + SIGTERM) << bridge.said();
  ASSERT_EQ(subscriber.end(20s), 0);
  const auto poses = messagesOf(subscriber.said(), "rt/motorcade/pose");
  EXPECT_GT(poses.size(), static_cast<std::size_t>(MOTORCADE_RENDERED_FRAMES)) << "more than one pass";
  const auto stamp = [](const json& pose) {
    return pose["header"]["sec"].get<std::int64_t>() * 1'000'000'000 + pose["header"]["nanosec"].get<std::int64_t>();
  };
  for (std::size_t i = 1; i < poses.size(); ++i) EXPECT_GT(stamp(poses[i]), stamp(poses[i - 1])) << i;
}

TEST_F(Bridge, RunsWithoutSubscribersAndWaitsForThemOnlySoLong) {
  Process alone = bridge({"--rate", "max"});
  EXPECT_EQ(alone.end(30s), 0) << alone.said();
  Process waiting = bridge({"--rate", "max", "--wait-for-subscribers", "1", "--wait-at-most", "0.2"});
  EXPECT_EQ(waiting.end(30s), 0);
  EXPECT_THAT(waiting.said(), HasSubstr("not every topic has 1 subscribers after 0.2 s"));
  EXPECT_THAT(waiting.said(), HasSubstr("/motorcade/pose: 14 messages published"));
  Process interrupted = bridge({"--wait-for-subscribers", "1"});
  std::this_thread::sleep_for(500ms);
  interrupted.tell(SIGINT);
  EXPECT_EQ(interrupted.end(10s), 128 + SIGINT) << interrupted.said();
}

TEST_F(Bridge, SaysWhatCannotBeUsed) {
  const auto expectEnd = [&](const std::vector<std::string>& options, const std::string& drive, int code,
                             const std::string& what) {
    Process process = bridge(options, drive);
    EXPECT_EQ(process.end(30s), code) << what;
    EXPECT_THAT(process.said(), HasSubstr(what));
  };
  expectEnd({}, "/nonexistent/drive", 3, "/nonexistent/drive");
  expectEnd({"--frame-ids", "map"}, kDrive, 2, "write WORLD,CHILD");
  expectEnd({"--topics", "pose,objects"}, kDrive, 2, "write some of pose, odometry, markers, tracked_objects");
  expectEnd({"--mounting", "1.6,0"}, kDrive, 2, "write X,Y,Z,ROLL,PITCH,YAW");
  expectEnd({"--rate", "fast"}, kDrive, 2, "--rate fast");
  expectEnd({"--interface", "203.0.113.7"}, kDrive, 2, "no interface of this machine");
  expectEnd({"--config", "/nonexistent.toml"}, kDrive, 2, "/nonexistent.toml");
}

ros::MarkerArray manyMarkers() {
  ros::Marker marker;
  marker.header.frame_id = "odom";
  marker.text = std::string(200, 'x');
  return {.markers = std::vector<ros::Marker>(100, marker)};
}

TEST_F(Bridge, AStoppedSubscriberHoldsNothingUpAndIsCounted) {
  Process subscriber = this->subscriber();
  const auto start = std::chrono::steady_clock::now();
  {
    DdsPublisher publisher({.domain = domain_}, {Topic::kPose, Topic::kMarkers});
    ASSERT_TRUE(publisher.waitForSubscribers(1, 20s, {}));
    subscriber.tell(SIGSTOP);
    const ros::MarkerArray array = manyMarkers();
    constexpr int kMessages = 200;
    const auto before = std::chrono::steady_clock::now();
    for (int i = 0; i < kMessages; ++i) publisher.publish(array);
    EXPECT_LT(std::chrono::steady_clock::now() - before, kMessages * 10ms);
    const auto objects = publisher.counts()[1];
    EXPECT_EQ(objects.published + objects.timed_out, kMessages);
    EXPECT_GE(objects.overtaken + objects.timed_out, kMessages - 20) << "all but what the history and buffers hold";
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, 25s);
  subscriber.tell(SIGCONT);
}

/// Each is bound to an address of the loopback interface, or to its device.
TEST_F(Bridge, NoSocketIsReachableFromOutsideOfTheMachine) {
  const DdsPublisher publisher({.domain = domain_}, topicsOf(kDefaultTopics));
  EXPECT_TRUE(publisher.isShielded());
  int sockets = 0;
  for (int descriptor = 0; descriptor < 1024; ++descriptor) {
    sockaddr_in address{};
    socklen_t size = sizeof(address);
    if (::getsockname(descriptor, reinterpret_cast<sockaddr*>(&address), &size) != 0) continue;
    if (address.sin_family != AF_INET) continue;
    std::array<char, 16> device{};
    size = device.size();
    ::getsockopt(descriptor, SOL_SOCKET, SO_BINDTODEVICE, device.data(), &size);
    const bool loopback = (ntohl(address.sin_addr.s_addr) >> 24) == 127 || std::string(device.data()) == "lo";
    EXPECT_TRUE(loopback) << "port " << ntohs(address.sin_port);
    ++sockets;
  }
  EXPECT_GE(sockets, 3) << "two that receive, one that sends";
}

}  // namespace
}  // namespace motorcade::test
