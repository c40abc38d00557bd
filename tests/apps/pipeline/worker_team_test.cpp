#include "apps/pipeline/worker_team.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <functional>
#include <latch>
#include <mutex>
#include <semaphore>
#include <stop_token>
#include <string>
#include <thread>

#include <gtest/gtest.h>

namespace motorcade {
namespace {

namespace flow = oneapi::tbb::flow;

constexpr std::chrono::seconds kPatience(60);  // with work of milliseconds, also under ThreadSanitizer

/// Ends the program with a message when a test hangs: nothing else ends threads that wait for each other.
class Watch {
 public:
  explicit Watch(const std::function<std::string()>& told)
      : thread_([this, told](const std::stop_token& over) {
          std::unique_lock lock(mutex_);
          if (changed_.wait_for(lock, over, kPatience, [&] { return over.stop_requested(); })) return;
          ADD_FAILURE() << "the team hangs: " << told();
          std::_Exit(EXIT_FAILURE);
        }) {}

 private:
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::jthread thread_;
};

/// Waits until all have come. They do not where one worker is awake alone.
bool meet(std::latch& all) {
  all.count_down();
  for (const auto until = std::chrono::steady_clock::now() + kPatience / 4; !all.try_wait();) {
    if (std::chrono::steady_clock::now() > until) return false;
    std::this_thread::sleep_for(std::chrono::microseconds(50));
  }
  return true;
}

/// A team that works on tasks of two parts.
class WorkingTeam : public testing::Test {
 protected:
  /// Calls the team for each of `tasks` tasks from another thread, as the pump does.
  void work(int workers, int tasks, const std::function<void(int)>& body) {
    std::atomic<int> called = 0, done = 0;
    const Watch watch([&] {
      return std::to_string(done) + " tasks are done, " + std::to_string(called) + " of " + std::to_string(tasks) +
             " were called for";
    });
    oneapi::tbb::task_arena arena(workers, static_cast<unsigned>(workers));
    WorkerTeam team(arena, workers, {});
    std::latch wired(1), closed(1);
    std::counting_semaphore<> finished(0);
    flow::receiver<int>* first = nullptr;
    std::jthread leader([&] {
      arena.execute([&] {
        oneapi::tbb::task_group_context context(oneapi::tbb::task_group_context::isolated,
                                                oneapi::tbb::task_group_context::concurrent_wait);
        flow::graph graph(context);
        flow::function_node<int, int> node(graph, flow::unlimited, [&](int task) {
          body(task);
          team.reachTail();
          return task;
        });
        flow::function_node<int, flow::continue_msg> tail(graph, flow::serial, [&](int) {
          team.finish();
          ++done;
          if (one_by_one_) finished.release();
        });
        flow::make_edge(node, tail);
        first = &node;
        wired.count_down();
        if (late_) closed.wait();
        team.lead(graph);
      });
    });
    wired.wait();
    for (int task = 0; task < tasks; ++task) {
      team.expect();
      first->try_put(task);
      team.call();
      ++called;
      if (one_by_one_) finished.acquire();
    }
    team.close();
    closed.count_down();
    leader.join();
  }
  bool one_by_one_ = false;  // the next task comes when the one before is done
  bool late_ = false;        // the leader begins when the team is closed already
};

TEST_F(WorkingTeam, DoesAllThatItIsCalledFor) {
  for (const int workers : {1, 2, 3}) {
    std::atomic<int> done = 0;
    work(workers, 1000, [&](int) { ++done; });
    EXPECT_EQ(done, 1000);
  }
}

TEST_F(WorkingTeam, IsAwakeAsAWhole) {
  std::latch all(2);  // each task waits for the other
  work(2, 2, [&](int) { EXPECT_TRUE(meet(all)) << "one worker is awake alone"; });
}

TEST_F(WorkingTeam, IsAwakeAsAWholeAlsoWhenItIsClosedBeforeItsLeaderBegins) {
  late_ = true;
  for (int run = 0; run < 20; ++run) {  // whichever seat the leader has
    std::latch all(2);
    work(2, 2, [&](int) { EXPECT_TRUE(meet(all)) << "one worker is awake alone, in run " << run; });
  }
}

TEST_F(WorkingTeam, ComesTogetherForEachTaskAnew) {
  one_by_one_ = true;
  for (const int workers : {1, 2, 3}) {
    std::atomic<int> done = 0;
    work(workers, 300, [&](int) { ++done; });
    EXPECT_EQ(done, 300);
  }
}

TEST_F(WorkingTeam, EndsWithoutACall) {
  for (const int workers : {1, 2, 4}) work(workers, 0, [](int) {});
  SUCCEED();
}

}  // namespace
}  // namespace motorcade
