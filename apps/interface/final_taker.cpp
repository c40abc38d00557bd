#include "apps/interface/final_taker.hpp"

#include <utility>

namespace motorcade {

/// Marks this thread, as long as it lives, as the one that calls the callback. It keeps the callback alive.
class FinalTaker::Handing {
 public:
  explicit Handing(FinalTaker& of) : of_(of) {
    const std::scoped_lock lock(of.mutex_);
    taker_ = of.taker_;
    of.handing_ = std::this_thread::get_id();
  }
  ~Handing() {
    taker_.reset();  // may call what it likes when it is destroyed, so without the lock
    const std::scoped_lock lock(of_.mutex_);
    of_.handing_ = {};
    of_.returned_.notify_all();
  }
  Handing(const Handing&) = delete;
  Handing& operator=(const Handing&) = delete;
  void call(Result final) const {
    if (taker_) (*taker_)(std::move(final));
  }

 private:
  FinalTaker& of_;
  std::shared_ptr<const Taker> taker_;
};

void FinalTaker::handTo(Taker taker) {
  auto next = taker ? std::make_shared<const Taker>(std::move(taker)) : nullptr;
  std::unique_lock lock(mutex_);
  taker_.swap(next);
  returned_.wait(lock, [this] { return handing_ == std::thread::id{} || handing_ == std::this_thread::get_id(); });
  lock.unlock();  // the callback before may do what it likes when it is destroyed
}

bool FinalTaker::isThere() const {
  const std::scoped_lock lock(mutex_);
  return taker_ != nullptr;
}

void FinalTaker::give(Result final) { Handing(*this).call(std::move(final)); }

}  // namespace motorcade
