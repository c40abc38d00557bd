#include "apps/view/viewers.hpp"

#include <utility>

namespace motorcade {

Viewers::Seat::~Seat() {
  const std::scoped_lock lock(viewers_.mutex_);
  std::erase(viewers_.seats_, this);
  viewers_.count_ = viewers_.seats_.size();
  viewers_.last_left_ = std::chrono::steady_clock::now();
}

EventText Viewers::Seat::next(std::chrono::milliseconds patience) {
  std::unique_lock lock(viewers_.mutex_);
  viewers_.changed_.wait_for(lock, patience, [this] { return newest_ || viewers_.closed_; });
  return std::exchange(newest_, nullptr);
}

bool Viewers::Seat::over() const {
  const std::scoped_lock lock(viewers_.mutex_);
  return viewers_.closed_ && !newest_;
}

std::int64_t Viewers::Seat::missed() const {
  const std::scoped_lock lock(viewers_.mutex_);
  return missed_;
}

std::shared_ptr<Viewers::Seat> Viewers::admit() {
  auto seat = std::make_shared<Seat>(*this);
  const std::scoped_lock lock(mutex_);
  if (closed_ || seats_.size() >= kMost) return nullptr;
  seat->newest_ = last_;
  seats_.push_back(seat.get());
  count_ = seats_.size();
  return seat;
}

void Viewers::publish(const EventText& event) {
  {
    const std::scoped_lock lock(mutex_);
    if (closed_) return;
    last_ = event;
    for (Seat* const seat : seats_)
      if (std::exchange(seat->newest_, event)) ++seat->missed_;
  }
  changed_.notify_all();
}

void Viewers::close() {
  {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
}

std::chrono::steady_clock::duration Viewers::absence() const {
  const std::scoped_lock lock(mutex_);
  if (!seats_.empty()) return {};
  return std::chrono::steady_clock::now() - last_left_;
}

}  // namespace motorcade
