#include <array>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "apps/bridge/dds_publisher.hpp"
#include "apps/bridge/message_conversion.hpp"
#include "motorcade/motorcade.hpp"
#include "tests/support/matchers.hpp"

/// `motorcade bridge` as other processes see it: what a subscriber gets, and what it may do to the bridge.
namespace motorcade::test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using nlohmann::json;
using testing::HasSubstr;

constexpr const char* kDrive = MOTORCADE_TINY_SEQUENCE;

/// One that others hardly use, and below the ports that the system gives away.
int unlikelyDomain() { return 60 + ::getpid() % 40; }

std::string contentOf(const fs::path& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// A program that is running; killed at the end where it still does.
class Process {
 public:
  Process(const std::vector<std::string>& words, const fs::path& output) : output_(output), id_(::fork()) {
    if (id_ != 0) return;
    if (std::freopen(output.c_str(), "w", stdout) == nullptr || ::dup2(1, 2) < 0) ::_exit(126);
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    ::execv(arguments[0], arguments.data());
    ::_exit(127);
  }
  ~Process() {
    if (running_) tell(SIGKILL);
    if (running_) ::waitpid(id_, nullptr, 0);
    fs::remove(output_);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void tell(int signal) const { ::kill(id_, signal); }
  /// The exit code; -1 where it does not end in time.
  int end(std::chrono::seconds patience) {
    const auto deadline = std::chrono::steady_clock::now() + patience;
    int status = 0;
    while (std::chrono::steady_clock::now() < deadline) {
      if (::waitpid(id_, &status, WNOHANG) == id_) {
        running_ = false;
        return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
      }
      std::this_thread::sleep_for(5ms);
    }
    return -1;
  }
  std::string said() const { return contentOf(output_); }

 private:
  fs::path output_;
  pid_t id_;
  bool running_ = true;
};

class Bridge : public testing::Test {
 protected:
  Process bridge(const std::vector<std::string>& options, const std::string& drive = kDrive) const {
    std::vector<std::string> words{MOTORCADE_PROGRAM, "bridge", drive, "--domain", std::to_string(domain_)};
    words.insert(words.end(), options.begin(), options.end());
    return {words, file("bridge")};
  }
  Process subscriber() const { return {{BRIDGE_SUBSCRIBER, std::to_string(domain_), "60"}, file("subscriber")}; }

  const int domain_ = unlikelyDomain();

 private:
  static fs::path file(const std::string& name) {
    return fs::path(testing::TempDir()) / ("motorcade_bridge_" + std::to_string(::getpid()) + "_" + name);
  }
};

std::vector<Result> trackedHere() {
  Recording recording(kDrive);
  Tracker tracker(recording.camera(), {.policy = Tracker::Policy::kReplay, .axes = Tracker::Axes::kRep103});
  for (std::int64_t i = 0; i < recording.size(); ++i) tracker.push(recording.read(i));
  tracker.close();
  std::vector<Result> results;
  while (!tracker.done())
    if (auto result = tracker.wait(1s)) results.push_back(*std::move(result));
  return results;
}

/// The messages of one topic in the order in which they came.
std::vector<json> messagesOf(const std::string& lines, const std::string& topic) {
  std::vector<json> messages;
  std::istringstream stream(lines);
  for (std::string line; std::getline(stream, line);)
    if (auto message = json::parse(line); message["topic"] == topic) messages.push_back(std::move(message));
  return messages;
}

void expectStamped(const json& header, const Result& result) {
  EXPECT_EQ(header["sec"].get<std::int64_t>() * 1'000'000'000 + header["nanosec"].get<std::int64_t>(), result.stamp_ns);
  EXPECT_EQ(header["frame_id"], "map");
}

/// The tracker here and the one of the program are linked apart, and may round the last bits differently.
constexpr double kRounding = 1e-9;

template <class Numbers>
void expectNumbers(const json& message, const Numbers& expected) {
  EXPECT_THAT(message.get<std::vector<double>>(), testing::Pointwise(testing::DoubleNear(kRounding), expected));
}

void expectPose(const json& pose, const Result& result) {
  const SE3 T_world_cam = transformOf(result.T_world_cam);
  EXPECT_THAT(Eigen::Vector3d(pose[0], pose[1], pose[2]), IsNear(T_world_cam.translation(), kRounding));
  const Eigen::Quaterniond q(pose[6], pose[3], pose[4], pose[5]);
  EXPECT_THAT(q.toRotationMatrix(), IsNear(T_world_cam.rotation(), kRounding));
}

void expectOdometry(const json& message, const Result& result) {
  expectStamped(message["header"], result);
  expectPose(message["pose"], result);
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
    expectStamped(poses[i]["header"], results[i]);
    expectPose(poses[i]["pose"], results[i]);
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
    DdsPublisher publisher({.domain = domain_});
    ASSERT_TRUE(publisher.waitForSubscribers(1, 20s, {}));
    subscriber.tell(SIGSTOP);
    const ros::MarkerArray array = manyMarkers();
    constexpr int kMessages = 200;
    const auto before = std::chrono::steady_clock::now();
    for (int i = 0; i < kMessages; ++i) publisher.publish(array);
    EXPECT_LT(std::chrono::steady_clock::now() - before, kMessages * 10ms);
    const auto objects = publisher.counts()[2];
    EXPECT_EQ(objects.published + objects.timed_out, kMessages);
    EXPECT_GE(objects.overtaken + objects.timed_out, kMessages - 20) << "all but what the history and buffers hold";
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, 25s);
  subscriber.tell(SIGCONT);
}

/// Each is bound to an address of the loopback interface, or to its device.
TEST_F(Bridge, NoSocketIsReachableFromOutsideOfTheMachine) {
  const DdsPublisher publisher({.domain = domain_});
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
