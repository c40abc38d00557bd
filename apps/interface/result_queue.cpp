#include "apps/interface/result_queue.hpp"

#include <utility>

namespace motorcade {

ResultQueue::Taker ResultQueue::put(Result& result) {
  const std::scoped_lock lock(mutex_);
  ++given_;
  if (taker_) {
    if (under_way_ > 0) --under_way_;
    went_.notify_all();
    return taker_;
  }
  if (results_.size() == kMost) {
    results_.pop_front();
    ++untaken_;
  }
  results_.push_back(std::move(result));
  came_.notify_one();
  return {};
}

void ResultQueue::close() {
  const std::scoped_lock lock(mutex_);
  closed_ = true;
  came_.notify_all();
  went_.notify_all();
}

bool ResultQueue::waitForRoom(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  if (!went_.wait_for(lock, patience, [this] { return under_way_ < kMost || closed_; })) return false;
  ++under_way_;
  return true;
}

void ResultQueue::giveUpRoom() {
  const std::scoped_lock lock(mutex_);
  if (under_way_ > 0) --under_way_;
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
  return take();
}

std::optional<Result> ResultQueue::wait(std::chrono::milliseconds timeout) {
  std::unique_lock lock(mutex_);
  came_.wait_for(lock, timeout, [this] { return !results_.empty() || closed_; });
  return take();
}

bool ResultQueue::done() const {
  const std::scoped_lock lock(mutex_);
  return closed_ && results_.empty();
}

void ResultQueue::handTo(Taker taker) {
  const std::scoped_lock lock(mutex_);
  taker_ = std::move(taker);
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
