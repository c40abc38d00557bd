#pragma once

#include <atomic>
#include <chrono>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <utility>

#include <unistd.h>

namespace motorcade {

/// A thread whose work begins with a call that waits.
class WaitingThread {
 public:
  template <class Work>
  explicit WaitingThread(Work work)
      : thread_([this, work = std::move(work)] {
          id_ = gettid();
          work();
        }) {}
  void join() { thread_.join(); }

  /// Returns when it has slept for some milliseconds: nothing but that call makes it do so.
  void awaitSleep() const {
    constexpr int kLooks = 10;
    for (int asleep = 0; asleep < kLooks; asleep = isAsleep() ? asleep + 1 : 0)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }

 private:
  bool isAsleep() const {
    std::ifstream file("/proc/self/task/" + std::to_string(id_) + "/stat");
    const std::string line((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    const auto name_ends = line.rfind(')');
    return name_ends != std::string::npos && line.compare(name_ends, 3, ") S") == 0;
  }

  std::atomic<pid_t> id_{-1};
  std::jthread thread_;
};

}  // namespace motorcade
