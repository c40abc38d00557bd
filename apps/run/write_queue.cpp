#include "apps/run/write_queue.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace motorcade {

ResultFiles::ResultFiles(RunFolderWriter& folder, ObjectViewWriter* views, FaultSpec faults)
    : folder_(folder), views_(views), faults_(std::move(faults)) {}

void ResultFiles::write(const WrittenResult& written) const {
  const PipelineResult& result = written.result;
  writeDropped(result);
  if (written.has_frame) writeFrame(result, written.has_view);
  for (const FrameEstimate& estimate : result.finals) folder_.writeFinal(estimate);
}

void ResultFiles::writeDropped(const PipelineResult& result) const {
  for (const FrameEstimate& estimate : result.dropped) {
    FrameTiming timing;
    timing.head = estimate.head;
    timing.due = timing.published = result.timing.due;
    folder_.writeTiming(timing);
    folder_.writeOnline(estimate);
  }
}

void ResultFiles::writeFrame(const PipelineResult& result, bool with_view) const {
  std::this_thread::sleep_for(std::chrono::duration<double>(diskStall_s(faults_, result.online.head.frame)));
  folder_.writeTiming(result.timing);
  folder_.writeOnline(result.online);
  if (views_ && with_view) views_->write(result);
  for (const FrameEstimate& estimate : result.settled) folder_.writeSettled(estimate);
}

namespace {

/// A hundred seconds of a camera of 10 Hz, some 10 MB; masks and points of a frame take ten times as much as the rest.
constexpr WriteQueue::Bounds kLiveBounds{.results = 1024, .with_views = 64};
constexpr WriteQueue::Bounds kReplayBounds{.results = 8, .with_views = 8};

}  // namespace

WriteQueue::Bounds WriteQueue::boundsOf(InputPolicy policy) {
  return policy == InputPolicy::kLive ? kLiveBounds : kReplayBounds;
}

WriteQueue::WriteQueue(Write write, const Bounds& bounds)
    : write_(std::move(write)), bounds_(bounds), load_{.bound = bounds.results}, thread_([this] { writeAll(); }) {}

WriteQueue::~WriteQueue() { end(); }

void WriteQueue::push(WrittenResult written) {
  std::unique_lock lock(mutex_);
  waitForRoom(lock);
  if (failure_) std::rethrow_exception(failure_);
  if (written.has_view && waiting_.size() >= bounds_.with_views) {
    written.has_view = false;
    ++load_.views_left_out;
  }
  if (!written.has_view) written.result.masks.clear(), written.result.measurements.reset();
  waiting_.push_back(std::move(written));
  load_.high_water = std::max(load_.high_water, waiting_.size());
  lock.unlock();
  pushed_.notify_one();
}

void WriteQueue::waitForRoom(std::unique_lock<std::mutex>& lock) {
  const auto has_room = [&] { return waiting_.size() < bounds_.results || failure_; };
  if (has_room()) return;
  ++load_.waits;
  const auto start = std::chrono::steady_clock::now();
  popped_.wait(lock, has_room);
  load_.waited_s += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

void WriteQueue::close() {
  end();
  if (failure_) std::rethrow_exception(failure_);
}

void WriteQueue::end() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  pushed_.notify_one();
  if (thread_.joinable()) thread_.join();
}

/// A result keeps its place until it is written: what is being written waits, too.
void WriteQueue::writeAll() {
  std::unique_lock lock(mutex_);
  for (;;) {
    pushed_.wait(lock, [&] { return !waiting_.empty() || ending_; });
    if (waiting_.empty()) return;
    const WrittenResult& written = waiting_.front();  // a deque that grows at its end leaves it where it is
    lock.unlock();
    try {
      write_(written);
    } catch (...) {
      lock.lock();
      failure_ = std::current_exception();
      waiting_.clear();
      popped_.notify_all();
      return;
    }
    lock.lock();
    waiting_.pop_front();
    popped_.notify_one();
  }
}

}  // namespace motorcade
