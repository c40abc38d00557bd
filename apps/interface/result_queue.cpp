#include "apps/interface/result_queue.hpp"

#include <algorithm>
#include <iterator>
#include <new>
#include <utility>

namespace motorcade {
namespace {

/// Clamps a duration to a year, which any clock can count.
std::chrono::milliseconds bounded(std::chrono::milliseconds time) {
  constexpr std::chrono::milliseconds kYear = std::chrono::hours(24 * 365);
  return std::clamp(time, std::chrono::milliseconds(0), kYear);
}

}  // namespace

void ResultQueue::put(Result result) {
  std::unique_lock lock(mutex_);
  if (live_) went_.wait(lock, [this] { return !callbackIsBusy() || abandoned_ || discarding_; });
  ++given_;
  if (discarding_) {
    ++untaken_;
    return;
  }
  if (results_.size() == kMost) {
    results_.pop_front();
    ++untaken_;
  }
  try {
    results_.push_back(std::move(result));
  } catch (const std::bad_alloc&) {
    ++untaken_;
    if (under_way_ > 0) --under_way_;
  }
  came_.notify_all();
}

void ResultQueue::close() {
  const std::scoped_lock lock(mutex_);
  closed_ = true;
  came_.notify_all();
  went_.notify_all();
}

void ResultQueue::abandon() {
  const std::scoped_lock lock(mutex_);
  closed_ = abandoned_ = room_for_all_ = true;
  came_.notify_all();
  went_.notify_all();
}

void ResultQueue::dropAll() {
  untaken_ += std::ssize(results_);
  results_.clear();
}

void ResultQueue::discard() {
  const std::scoped_lock lock(mutex_);
  dropAll();
  discarding_ = room_for_all_ = true;
  went_.notify_all();
}

void ResultQueue::restart() {
  const std::scoped_lock lock(mutex_);
  dropAll();
  closed_ = discarding_ = room_for_all_ = false;
  under_way_ = 0;
}

bool ResultQueue::waitForRoom(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  if (!went_.wait_for(lock, bounded(patience), [this] { return under_way_ < kMost || room_for_all_; })) return false;
  ++under_way_;
  return true;
}

void ResultQueue::endWaitsForRoom() {
  const std::scoped_lock lock(mutex_);
  room_for_all_ = true;
  went_.notify_all();
}

void ResultQueue::giveUpRoom() {
  const std::scoped_lock lock(mutex_);
  if (under_way_ > 0) --under_way_;
  went_.notify_all();
}

std::optional<Result> ResultQueue::take() {
  if (results_.empty()) return std::nullopt;
  std::optional<Result> result(std::move(results_.front()));
  results_.pop_front();
  if (under_way_ > 0) --under_way_;
  went_.notify_all();
  return result;
}

std::optional<Result> ResultQueue::poll() {
  const std::scoped_lock lock(mutex_);
  return taker_ ? std::nullopt : take();
}

std::optional<Result> ResultQueue::wait(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  came_.wait_for(lock, bounded(timeout), [this] { return !results_.empty() || closed_ || taker_; });
  return taker_ ? std::nullopt : take();
}

bool ResultQueue::done() const {
  const std::scoped_lock lock(mutex_);
  return abandoned_ || (closed_ && results_.empty() && handing_ == std::thread::id{});
}

void ResultQueue::handTo(Taker taker) {
  auto next = taker ? std::make_shared<const Taker>(std::move(taker)) : nullptr;
  std::unique_lock lock(mutex_);
  taker_.swap(next);
  came_.notify_all();
  went_.notify_all();
  went_.wait(lock, [this] { return handing_ == std::thread::id{} || handing_ == std::this_thread::get_id(); });
  lock.unlock();  // the callback before may do what it likes when it is destroyed
}

/// Marks this thread, as long as it lives, as the one that calls a callback.
class ResultQueue::Handing {
 public:
  Handing(ResultQueue& queue, std::shared_ptr<const Taker> taker) : queue_(queue), taker_(std::move(taker)) {
    queue_.handing_ = std::this_thread::get_id();
  }
  ~Handing() {
    taker_.reset();
    const std::scoped_lock lock(queue_.mutex_);
    queue_.handing_ = {};
    queue_.went_.notify_all();
  }
  Handing(const Handing&) = delete;
  Handing& operator=(const Handing&) = delete;
  void call(Result result) const { (*taker_)(std::move(result)); }

 private:
  ResultQueue& queue_;
  std::shared_ptr<const Taker> taker_;
};

bool ResultQueue::handNext() {
  std::unique_lock lock(mutex_);
  came_.wait(lock, [this] { return abandoned_ || (taker_ && !results_.empty()); });
  if (abandoned_) return false;
  auto result = take();
  const Handing handing(*this, taker_);
  lock.unlock();
  handing.call(std::move(*result));
  return true;
}

std::int64_t ResultQueue::given() const {
  const std::scoped_lock lock(mutex_);
  return given_;
}

std::int64_t ResultQueue::untaken() const {
  const std::scoped_lock lock(mutex_);
  return untaken_;
}

}  // namespace motorcade
