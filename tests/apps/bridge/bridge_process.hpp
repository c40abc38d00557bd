#pragma once

#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

#include "core/se3.hpp"
#include "motorcade/motorcade.hpp"
#include "tests/apps/bridge/claimed_domain.hpp"
#include "tests/io/temporary_folder.hpp"
#include "tests/support/matchers.hpp"

/// Processes of `motorcade bridge` and its subscriber, and the messages expected of them.
namespace motorcade::test {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using nlohmann::json;

inline constexpr const char* kDrive = MOTORCADE_TINY_SEQUENCE;

/// A program that is running; it is killed at the end if it still does.
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
  /// Waits for the exit code; -1 where the program does not end in time.
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
  const ClaimedDomain claimed_;

 protected:
  Process bridge(const std::vector<std::string>& options, const std::string& drive = kDrive) const {
    std::vector<std::string> words{MOTORCADE_PROGRAM, "bridge", drive, "--domain", std::to_string(domain_)};
    words.insert(words.end(), options.begin(), options.end());
    return {words, file("bridge")};
  }
  Process subscriber() const { return {{BRIDGE_SUBSCRIBER, std::to_string(domain_), "60"}, file("subscriber")}; }

  const int domain_ = claimed_.number();

 private:
  static fs::path file(const std::string& name) {
    return fs::path(testing::TempDir()) / ("motorcade_bridge_" + std::to_string(::getpid()) + "_" + name);
  }
};

inline std::vector<Result> trackedHere() {
  Recording recording(kDrive);
  Tracker tracker(recording.camera(), {.policy = Tracker::Policy::kReplay, .axes = Tracker::Axes::kRep103});
  for (std::int64_t i = 0; i < recording.size(); ++i) tracker.push(recording.read(i));
  tracker.close();
  std::vector<Result> results;
  while (!tracker.done())
    if (auto result = tracker.wait(1s)) results.push_back(*std::move(result));
  return results;
}

/// Messages of one topic in the order in which they came.
inline std::vector<json> messagesOf(const std::string& lines, const std::string& topic) {
  std::vector<json> messages;
  std::istringstream stream(lines);
  for (std::string line; std::getline(stream, line);)
    if (auto message = json::parse(line); message["topic"] == topic) messages.push_back(std::move(message));
  return messages;
}

/// The tracker of the tests and the one of the program are linked apart, and may round the last bits differently.
inline constexpr double kProgramRounding = 1e-9;

inline void expectStamped(const json& header, const Result& result, const std::string& frame_id) {
  EXPECT_EQ(header["sec"].get<std::int64_t>() * 1'000'000'000 + header["nanosec"].get<std::int64_t>(), result.stamp_ns);
  EXPECT_EQ(header["frame_id"], frame_id);
}

template <class Numbers>
void expectNumbers(const json& message, const Numbers& expected) {
  EXPECT_THAT(message.get<std::vector<double>>(), testing::Pointwise(testing::DoubleNear(kProgramRounding), expected));
}

inline void expectPose(const json& pose, const SE3& T) {
  EXPECT_THAT(Eigen::Vector3d(pose[0], pose[1], pose[2]), IsNear(T.translation(), kProgramRounding));
  const Eigen::Quaterniond q(pose[6], pose[3], pose[4], pose[5]);
  EXPECT_THAT(q.toRotationMatrix(), IsNear(T.rotation(), kProgramRounding));
}

}  // namespace motorcade::test
